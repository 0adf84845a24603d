// SPDX-License-Identifier: BSD-3-Clause
#include "server/turns.hpp"

#include <algorithm>
#include <utility>

#include "server/session.hpp"

namespace unitylink::server {

bool Turns::add(Errand& errand) {
  if (errand.shareable) {
    if (Errand* const other = equal(errand)) {
      other->joined.push_back({errand.session, errand.id});
      joined_ += 1;
      return false;
    }
  }
  waiting_ += 1;
  auto user = std::ranges::find(users_, errand.session->user(), &User::number);
  if (user == users_.end()) {
    user = users_.insert(user, {errand.session->user(), {}});
  }
  const auto mine = std::ranges::find(user->lines, errand.session, &Line::session);
  if (mine != user->lines.end()) {
    mine->errands.push_back(&errand);
  } else {
    user->lines.push_back({errand.session, {&errand}});
  }
  return true;
}

Errand* Turns::equal(const Errand& errand) const noexcept {
  for (const User& user : users_) {
    for (const Line& line : user.lines) {
      for (Errand* const other : line.errands) {
        if (other->shareable && other->exchange.kind == errand.exchange.kind && other->body == errand.body) {
          return other;
        }
      }
    }
  }
  return nullptr;
}

Errand& Turns::next() {
  User user = std::move(users_.front());
  users_.pop_front();
  Line line = std::move(user.lines.front());
  user.lines.pop_front();
  Errand& errand = *line.errands.front();
  line.errands.pop_front();
  waiting_ -= 1;
  if (!line.errands.empty()) {
    user.lines.push_back(std::move(line));
  }
  if (!user.lines.empty()) {
    users_.push_back(std::move(user));
  }
  return errand;
}

void Turns::leave(const Session& session, std::vector<Errand*>& idle) {
  std::vector<Errand*> orphans;  // others have joined them
  for (User& user : users_) {
    for (Line& line : user.lines) {
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
    std::erase_if(user.lines, [](const Line& line) { return line.errands.empty(); });
  }
  std::erase_if(users_, [](const User& user) { return user.lines.empty(); });
  waiting_ -= orphans.size();
  for (Errand* const orphan : orphans) {
    static_cast<void>(add(*orphan));
  }
}

}  // namespace unitylink::server
