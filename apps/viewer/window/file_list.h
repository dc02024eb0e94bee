#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "window/interface.h"

namespace inktrace::viewer {

/// The folders and the readable files of a folder, to choose from.
class FileList {
  public:
    void enter(const std::filesystem::path& folder);
    const std::filesystem::path& folder() const { return folder_; }
    /// Draws the list. A click on a folder enters it, one on a file writes its path into `file`;
    /// true after a double click on a file.
    bool draw(Interface& interface, std::string& file);

  private:
    struct Entry {
        std::string name;
        bool is_folder;
    };
    std::filesystem::path folder_;
    std::vector<Entry> entries_;
};

}  // namespace inktrace::viewer
