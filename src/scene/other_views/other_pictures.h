// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <future>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include "scene/other_views/other_view.h"
#include "scene/view.h"

namespace ssdo {

/// A bit of OtherPicture::object_flags beside those of other_view.h: what has the shape of a
/// backdrop, and is not far enough by this picture alone.
inline constexpr unsigned char kNearBackdrop = 8;

/// The other pictures of a run: each is read once, and kept as long as frames will ask for it.
/// May be asked from several threads.
class OtherPictures {
 public:
  using Picture = OtherView::Picture;

  /// With `allow_partial`, missing chunks of the files of --also are no errors. `objects`: what
  /// casts nothing, which is marked by what the pictures themselves hold of it.
  explicit OtherPictures(bool allow_partial = false, ObjectOptions objects = {})
      : allow_partial_(allow_partial), objects_(std::move(objects)) {}

  /// Announces that `frame` will ask for its files, until it is released. Files that no frame
  /// expects any more are dropped; files that were never announced are kept.
  void expect(const FrameFiles& frame);
  void release(const FrameFiles& frame);

  /// A file of --also: a G-buffer whose layers are found by their names, and whose camera is fitted
  /// from its P. Nothing where the file is a deep image. `links` are those of the lamps, for
  /// OtherPicture::casts and receives. An error comes again in every call.
  /// Errors: those of the stages of a view; ExitCode::layer where P is missing or in camera space,
  /// and where no camera explains it.
  Picture also(const std::string& file, const LampLinks& links = {});

  /// Another frame of INPUT's sequence, or another view of INPUT, read as INPUT is.
  /// Errors: as also().
  Picture alike(const FrameFiles& frame, const InputOptions& input, const CameraOptions& camera);

 private:
  /// How a file is read, and its path.
  using Key = std::pair<std::string_view, std::string>;
  struct Entry {
    std::shared_future<Picture> picture;
    int frames = 0;  ///< that will ask for it
  };

  static std::vector<Key> keys_of(const FrameFiles& frame);
  Picture get(const Key& key, const std::function<Picture()>& read);

  const bool allow_partial_;
  const ObjectOptions objects_;
  std::mutex mutex_;
  std::map<Key, Entry> entries_;
};

}  // namespace ssdo
