// SPDX-License-Identifier: BSD-3-Clause
#include "server/turns.hpp"

#include <algorithm>
#include <utility>

namespace unitylink::server {

bool Turns::add(Errand& errand) {
  if (errand.shareable) {
    for (const Line& line : lines_) {
      for (Errand* const other : line.errands) {
        if (other->shareable && other->exchange.kind == errand.exchange.kind && other->body == errand.body) {
          other->joined.push_back({errand.session, errand.id});
          joined_ += 1;
          return false;
        }
      }
    }
  }
  waiting_ += 1;
  const auto mine = std::ranges::find(lines_, errand.session, &Line::session);
  if (mine != lines_.end()) {
    mine->errands.push_back(&errand);
  } else {
    lines_.push_back({errand.session, {&errand}});
  }
  return true;
}

Errand& Turns::next() {
  Line line = std::move(lines_.front());
  lines_.pop_front();
  Errand& errand = *line.errands.front();
  line.errands.pop_front();
  waiting_ -= 1;
  if (!line.errands.empty()) {
    lines_.push_back(std::move(line));
  }
  return errand;
}

void Turns::leave(const Session& session, std::vector<Errand*>& idle) {
  std::vector<Errand*> orphans;  // others have joined them
  for (Line& line : lines_) {
    std::erase_if(line.errands, [&](Errand* const errand) {
      if (errand->drop(session)) {
        return false;  // it never was in it, or another one leads it now
      }
      idle.push_back(errand);
      waiting_ -= 1;
      return true;
    });
    if (line.session == &session) {
      orphans.insert(orphans.end(), line.errands.begin(), line.errands.end());
      line.errands.clear();
    }
  }
  std::erase_if(lines_, [](const Line& line) { return line.errands.empty(); });
  waiting_ -= orphans.size();
  for (Errand* const orphan : orphans) {
    static_cast<void>(add(*orphan));
  }
}

}  // namespace unitylink::server
