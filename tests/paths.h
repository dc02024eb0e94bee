#pragma once

#include <filesystem>

namespace ink::test {

std::filesystem::path source_dir();  ///< of the project
/// Real files, where there are any: the folder need not exist.
std::filesystem::path data_dir();
std::filesystem::path program();  ///< the command-line program that was built with the tests

}  // namespace ink::test
