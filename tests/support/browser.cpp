// SPDX-License-Identifier: Apache-2.0
#include "support/browser.h"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <stdexcept>

#include "support/parse_json.h"

namespace ssdo::test {

Browser::Browser(const std::filesystem::path& profile, int width, int height) {
  int to[2], from[2];
  if (pipe2(to, O_CLOEXEC) != 0 || pipe2(from, O_CLOEXEC) != 0) throw std::runtime_error("no pipe");
  child_ = fork();
  if (child_ == 0) {
    // The browser reads from 3 and writes to 4, which may be ends of these very pipes.
    const int in = fcntl(to[0], F_DUPFD, 10), out = fcntl(from[1], F_DUPFD, 10);
    dup2(in, 3);
    dup2(out, 4);
    const int silent = open("/dev/null", O_RDWR);
    dup2(silent, STDOUT_FILENO);
    dup2(silent, STDERR_FILENO);
    const std::string folder = "--user-data-dir=" + profile.string();
    const std::string size =
        "--window-size=" + std::to_string(width) + "," + std::to_string(height);
    execlp("chromium", "chromium", "--headless", "--no-sandbox", "--disable-gpu",
           "--disable-dev-shm-usage", "--no-first-run", "--hide-scrollbars",
           "--remote-debugging-pipe", folder.c_str(), size.c_str(), "about:blank", nullptr);
    _exit(127);
  }
  close(to[0]);
  close(from[1]);
  in_ = from[0];
  out_ = to[1];
  const json target = call("Target.createTarget", {{"url", "about:blank"}});
  session_ = call("Target.attachToTarget", {{"targetId", target.at("targetId")}, {"flatten", true}})
                 .at("sessionId");
  for (const char* domain : {"Page", "Runtime", "Log", "Network"})
    call(std::string(domain) + ".enable");
}

Browser::~Browser() {
  close(out_);  // upon which the browser ends
  close(in_);
  for (int i = 0; i < 100; ++i) {
    if (waitpid(child_, nullptr, WNOHANG) != 0) return;
    usleep(100'000);
  }
  kill(child_, SIGKILL);
  waitpid(child_, nullptr, 0);
}

void Browser::open_page(const std::string& url) {
  loaded_ = false;
  call("Page.navigate", {{"url", url}});
  while (!loaded_) hear(receive());
}

Browser::json Browser::evaluate(const std::string& expression) {
  const json answer =
      call("Runtime.evaluate",
           {{"expression", expression}, {"awaitPromise", true}, {"returnByValue", true}});
  if (answer.contains("exceptionDetails")) complaints.push_back(answer.dump());
  return answer.at("result").value("value", json());
}

void Browser::mouse(const std::string& type, double x, double y) {
  call("Input.dispatchMouseEvent", {{"type", type},
                                    {"x", x},
                                    {"y", y},
                                    {"button", "left"},
                                    {"buttons", type == "mouseReleased" ? 0 : 1},
                                    {"clickCount", 1}});
}

std::string Browser::screenshot() { return call("Page.captureScreenshot").at("data"); }

Browser::json Browser::call(const std::string& method, json parameters) {
  json message = {{"id", ++last_id_}, {"method", method}, {"params", std::move(parameters)}};
  if (!session_.empty()) message["sessionId"] = session_;
  const std::string text = message.dump() + '\0';
  for (std::size_t sent = 0; sent < text.size();) {
    const ssize_t n = write(out_, text.data() + sent, text.size() - sent);
    if (n <= 0) throw std::runtime_error("the browser has gone; is chromium installed?");
    sent += std::size_t(n);
  }
  for (;;) {
    const json answer = receive();
    if (answer.value("id", 0) != last_id_) {
      hear(answer);
      continue;
    }
    if (answer.contains("error")) throw std::runtime_error(method + ": " + answer.dump());
    return answer.at("result");
  }
}

Browser::json Browser::receive() {
  for (std::size_t end; (end = buffer_.find('\0')) == std::string::npos;) {
    pollfd ready{in_, POLLIN, 0};
    char part[65536];
    const ssize_t n = poll(&ready, 1, 120'000) > 0 ? read(in_, part, sizeof part) : 0;
    if (n <= 0) throw std::runtime_error("the browser does not answer; is chromium installed?");
    buffer_.append(part, std::size_t(n));
  }
  const std::size_t end = buffer_.find('\0');
  const json message = parse_json(buffer_.substr(0, end));
  buffer_.erase(0, end + 1);
  return message;
}

void Browser::hear(const json& event) {
  const std::string method = event.value("method", "");
  if (method == "Page.loadEventFired") loaded_ = true;
  if (method == "Network.requestWillBeSent")
    requests.push_back(event.at("params").at("request").at("url"));
  const bool logged = method == "Runtime.consoleAPICalled" || method == "Log.entryAdded";
  if (logged || method == "Runtime.exceptionThrown") complaints.push_back(event.dump());
}

}  // namespace ssdo::test
