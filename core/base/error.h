// Input errors are for users and explain themselves; broken invariants are for us and throw std::logic_error.
#pragma once

#include <stdexcept>
#include <string>

namespace umbra {

/// Input that cannot be read. what() is the whole message: "FILE[:POSITION]: what was found, expected ...".
/// Commands print it and exit with 4.
class InputError : public std::runtime_error {
public:
    using std::runtime_error::runtime_error;
};

/// A mesh that a scene names is not there: the scene itself may be fine. The report leaves such scenes out.
class MissingMesh : public InputError {
public:
    using InputError::InputError;
};

/// A wrong command line or parameter. Commands print it and exit with 64.
class UsageError : public std::runtime_error {
public:
    using std::runtime_error::runtime_error;
};

/// A method threw or broke its contract. Commands print it and exit with 5.
class MethodError : public std::runtime_error {
public:
    using std::runtime_error::runtime_error;
};

/// The message of the exception that is being handled, for a record of a failure: one sentence for exhausted memory and
/// for anything that is not a std::exception. Only in a catch block.
[[nodiscard]] std::string current_message();

}  // namespace umbra
