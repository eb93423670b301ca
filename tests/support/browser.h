// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sys/types.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace ssdo::test {

/// A page in headless Chromium, driven through the DevTools protocol over a pair of pipes: messages
/// are JSON objects that end in a zero byte. Throws std::runtime_error when it does not answer.
class Browser {
 public:
  using json = nlohmann::json;

  /// `profile` is a folder for what the browser writes.
  Browser(const std::filesystem::path& profile, int width, int height);
  ~Browser();
  Browser(const Browser&) = delete;
  Browser& operator=(const Browser&) = delete;

  /// Opens a page and waits until it has loaded.
  void open_page(const std::string& url);

  /// The value of an expression, or of the promise that it gives.
  json evaluate(const std::string& expression);

  /// type: mousePressed, mouseMoved or mouseReleased, with the left button down. In CSS pixels.
  void mouse(const std::string& type, double x, double y);

  /// A PNG in base64 of what the window shows.
  std::string screenshot();

  std::vector<std::string> complaints;  ///< errors and warnings on the console, exceptions
  std::vector<std::string> requests;    ///< addresses that the page asked for

 private:
  json call(const std::string& method, json parameters = json::object());
  json receive();
  void hear(const json& event);

  pid_t child_ = -1;
  int in_ = -1, out_ = -1, last_id_ = 0;
  bool loaded_ = false;
  std::string session_, buffer_;
};

}  // namespace ssdo::test
