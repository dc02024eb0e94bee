#pragma once

#include <string>
#include <vector>

#include "bench_tables.h"
#include "gallery_figures.h"

namespace inktrace::cli {

/// Table 1 or 2: measured here, and the paper's.
struct GalleryTable {
    std::string title;
    const PaperTable& paper;
    std::vector<BenchRow> rows;  ///< empty: not measured
};

/// The gallery as a page of HTML, beside the pictures.
std::string gallery_page(const std::vector<Figure>& figures,
                         const std::vector<GalleryTable>& tables);

}  // namespace inktrace::cli
