#pragma once

namespace lodestone::report {

extern const char kPageStyle[];  ///< CSS, light and dark
/// Draws a chart from plain data in the colours of the page, and enlarges what is clicked on.
extern const char kPageScript[];

}  // namespace lodestone::report
