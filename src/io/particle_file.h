#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "io/particle_fields.h"
#include "io/reader.h"
#include "scene/particles.h"

// What the readers of particles share.
namespace ink {

/// The particles as a file's contents. Throws InputError where there are none, and Error where the
/// options ask for what is not there.
FileContents particle_contents(const std::filesystem::path& file, std::string_view format,
                               Particles particles, FileContents contents,
                               const ReadOptions& options);

/// Rows of numbers under named columns, of which only those are kept that are drawn.
class ParticleColumns {
  public:
    /// Throws InputError where there are no columns x, y and z.
    ParticleColumns(const std::filesystem::path& file, const std::vector<std::string>& names,
                    const ReadOptions& options);

    void reserve(std::size_t rows);
    /// Words end at `separator` (' ': at blanks). False where a word that is needed is missing or
    /// not a number; `problem` then says so. A column that colours or names parts may hold words
    /// instead, from the first row on.
    bool add_row(std::string_view row, char separator, std::string& problem);
    /// What to do about the problem, if it is not one of a single row; else empty.
    std::string_view remedy() const { return remedy_; }

    /// Coordinates that are fractions of a box, as LAMMPS writes them: which of x, y, z are.
    std::array<bool, 3> scaled() const { return scaled_; }
    /// After the last row.
    Particles& particles();
    std::vector<FieldSummary> summaries() const;

  private:
    struct Column {
        std::string name;
        bool needed = false;
        bool is_number = false;  ///< in every row; else words have no value
        bool may_be_words = false;
        std::map<std::string, float, std::less<>> words{};  ///< in the order that they come in
        int axis = -1;                                      ///< 0, 1, 2: a coordinate
        std::vector<FieldLayout::Place> destinations;
        double least, most;                         ///< of the finite values
        std::set<std::string, std::less<>> told{};  ///< words, for the summary
    };

    /// More words than these are names, which a summary leaves out.
    static constexpr std::size_t kMostTold = 10000;

    static void tell_word(Column& column, std::string_view word);
    bool take_word_of(Column& column, std::string_view word, double& value) const;
    void find_axes(const std::filesystem::path& file);

    std::vector<Column> columns_;
    std::string_view remedy_;
    std::size_t last_needed_ = 0;
    bool summarize_ = false;
    std::array<bool, 3> scaled_{};
    Particles particles_;
};

}  // namespace ink
