// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace ssdo {

/// One term of a selection.
struct SelectionTerm {
  enum class Kind {
    cryptomatte,  ///< objects, materials or assets by name
    ids,          ///< numbers of an id layer
    matte,        ///< a layer of coverage
  };
  /// The first and the last id of a range.
  struct Range {
    std::int64_t first, last;
  };

  Kind kind = Kind::matte;
  bool adds = true;        ///< else it is taken away from the terms before it
  std::string file;        ///< that holds it; empty: the frame itself
  std::string layer;       ///< of ids or of the matte
  std::string name;        ///< for a Cryptomatte; may hold *, ? and [...]
  std::vector<Range> ids;  ///< inclusive
};

/// Parts of a frame that the user names: SEL of the options of objects.
struct Selection {
  std::string option;  ///< that it is the value of, for messages
  std::string text;    ///< as the user wrote it
  std::vector<SelectionTerm> terms;

  bool empty() const { return terms.empty(); }
};

/// What the lamps of a frame are linked to.
struct LampLinks {
  std::vector<Selection> cast;     ///< what alone blocks the light of a lamp
  std::vector<Selection> receive;  ///< what alone a lamp lights
};

/// Parses `crypto:NAME`, `id:LAYER=1,5-7`, `LAYER` or `FILE:LAYER`, joined by + and -. A - joins
/// where a blank is before it or `crypto:` or `id:` behind it, since names hold it too; quotes keep
/// both signs in a name. A file is told from a name by its existence, as --aov does it.
/// Errors: ExitCode::usage.
Selection parse_selection(const std::string& option, const std::string& text);

/// `selection` with the patterns of its files replaced by `frame`.
Selection at_frame(Selection selection, int frame);

}  // namespace ssdo
