#pragma once

#include <stdexcept>
#include <string>

namespace inktrace {

/// What every function of the library throws when the user can put something right. The message
/// names the file or the setting, says what is wrong and what to do.
class Error : public std::runtime_error {
  public:
    enum class Kind {
        input,     ///< a file that cannot be read or written, or a scene that does not fit
        usage,     ///< a setting that is unknown or out of range
        cancelled  ///< the caller asked to stop
    };

    Error(Kind kind, const std::string& message) : std::runtime_error(message), kind_(kind) {}
    Kind kind() const { return kind_; }

  private:
    Kind kind_;
};

}  // namespace inktrace
