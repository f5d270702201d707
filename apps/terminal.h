#pragma once

#include <string>

#include "lodestone/session/operator.h"
#include "lodestone/session/rig_check.h"

namespace lodestone::apps {

/// True when somebody sits at the terminal.
bool has_operator();

/// Asks at the terminal whether to go on; `yes` answers for the operator. Without either the answer is no.
bool confirm(const std::string& question, bool yes);

/// Asks whoever sits at the terminal to place the needle; empty where nobody does.
session::AskedOperator::Ask terminal_operator(const physics::RigDescription& rig);

/// The terminal as a walk through the wiring talks to it.
class TerminalDialogue final : public session::Dialogue {
 public:
  /// `yes` answers every question.
  explicit TerminalDialogue(bool yes) : yes_(yes) {}
  void say(const std::string& text) override;
  bool confirm(const std::string& question) override { return apps::confirm(question, yes_); }
  bool attended() const override { return has_operator() && !yes_; }

 private:
  bool yes_;
};

}  // namespace lodestone::apps
