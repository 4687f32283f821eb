#pragma once

namespace CLI {
class Validator;
}

namespace xrds {

/// Checks that the text of an option is a number from `low` to `high`: CLI::Range lets "nan" through.
CLI::Validator numberIn(double low, double high);

}  // namespace xrds
