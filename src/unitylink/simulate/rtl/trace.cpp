// SPDX-License-Identifier: BSD-3-Clause
// Writes which instructions an engine executes, a pass through its program at a time. A pass that executes the
// same instructions as the one before it is only counted: an engine that waits makes thousands of them.
// trace.py defines TRACE_FILE, TRACE_NEXT and trace_lines.
#include <cstdint>
#include <cstdio>
#include <vector>

namespace {

class ProgramTrace {
 public:
  ProgramTrace() : file_(std::fopen(TRACE_FILE, "w")) {}
  ProgramTrace(const ProgramTrace&) = delete;
  ProgramTrace& operator=(const ProgramTrace&) = delete;
  ~ProgramTrace() {
    end_pass();
    if (file_ == nullptr) return;
    count_same();
    std::fclose(file_);
  }

  void step(std::uint64_t clock, std::uint32_t place) {
    if (file_ == nullptr) return;
    if (place == TRACE_NEXT) end_pass();
    clocks_.push_back(clock);
    places_.push_back(place);
  }

  void end_pass() {
    if (file_ == nullptr || places_.empty()) return;
    if (places_ == before_) {
      ++same_;
    } else {
      count_same();
      for (std::size_t n = 0; n < places_.size(); ++n)
        std::fprintf(file_, "%10llu  %s\n", static_cast<unsigned long long>(clocks_[n]), trace_lines[places_[n]]);
      std::fprintf(file_, "\n");
      std::fflush(file_);
      before_.swap(places_);
    }
    places_.clear();
    clocks_.clear();
  }

 private:
  void count_same() {
    if (same_ > 0) std::fprintf(file_, "            the same %llu times\n\n", static_cast<unsigned long long>(same_));
    same_ = 0;
  }

  std::FILE* file_;
  std::vector<std::uint32_t> places_, before_;
  std::vector<std::uint64_t> clocks_;
  std::uint64_t same_ = 0;
};

ProgramTrace& program_trace() {
  static ProgramTrace trace;
  return trace;
}

void unitylink_step(std::uint64_t clock, std::uint32_t place) { program_trace().step(clock, place); }

// A pass ends that the program itself does not lead on from.
[[maybe_unused]] void unitylink_pass() { program_trace().end_pass(); }

}  // namespace
