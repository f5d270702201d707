#include <filesystem>
#include <fstream>
#include <set>

#include "fuzz/fuzz.h"
#include "lodestone/console/answer.h"
#include "lodestone/console/served_files.h"
#include "temporary_folder.h"

using namespace lodestone;
using console::RequestHead;

namespace {

const std::string kFuzzToken = "0123456789abcdef0123456789abcdef";

const std::vector<std::string> kMethods = {"GET", "GET", "GET", "GET", "HEAD", "POST", "OPTIONS"};
const std::vector<std::string> kTargets = {"/",
                                           "/ws",
                                           "/?token=" + kFuzzToken,
                                           "/runs/a/report.html",
                                           "/runs/a/with%20space.csv",
                                           "/recordings/a.mp4",
                                           "/runs/../secret.txt",
                                           "/runs/%2e%2e%2fsecret.txt",
                                           "/runs/a/.hidden.txt",
                                           "/runs/out.txt",
                                           "/runs/up/secret.txt",
                                           "/runs/..\\secret.txt",
                                           "/console.js"};
const std::vector<std::string> kHosts = {"localhost:8080", "127.0.0.1:8080",   "[::1]:8080",
                                         "localhost",      "rig.example:8080", "evil.example"};
const std::vector<std::string> kOrigins = {"",
                                           "",
                                           "http://localhost:8080",
                                           "http://127.0.0.1:8080",
                                           "http://[::1]:8080",
                                           "https://localhost",
                                           "http://rig.example:8080",
                                           "http://evil.example",
                                           "null"};
const std::vector<std::string> kCookies = {"lodestone=" + kFuzzToken, "a=b; lodestone=" + kFuzzToken, "",
                                           "lodestone=fedcba9876543210fedcba9876543210"};
const std::vector<std::string> kSites = {"", "", "same-origin", "none", "same-site", "cross-site"};
const std::vector<std::string> kModes = {"", "navigate", "websocket", "no-cors", "cors"};
const std::vector<std::string> kRanges = {"",           "bytes=0-",  "bytes=2-4",    "bytes=-3",
                                          "bytes=5-99", "bytes=99-", "bytes=0-1,4-5"};

/// Spoils requests: most parts of each are good, so that it comes far.
class RequestSpoiler {
 public:
  explicit RequestSpoiler(std::uint64_t seed) : spoiler_(seed, "requests") {}

  RequestHead head() {
    RequestHead head;
    head.method = part(kMethods, 40);
    head.target = part(kTargets, 2);
    head.host = part(kHosts, 8);
    head.origin = spoiler_.below(2) == 0 ? part(kOrigins, 8) : part({"http://" + head.host}, 8);
    head.cookie = part(kCookies, 8);
    head.fetch_site = part(kSites, 20);
    head.fetch_mode = part(kModes, 20);
    head.range = part(kRanges, 4);
    head.upgrade = (head.target == "/ws") != (spoiler_.below(4) == 0);
    return head;
  }

 private:
  std::string part(const std::vector<std::string>& good, std::size_t one_spoiled_in) {
    const std::string& text = spoiler_.one_of(good);
    return spoiler_.below(one_spoiled_in) == 0 ? spoiler_.bytes(text, spoiler_.one_of(good)) : text;
  }

  tests::Spoiler spoiler_;
};

bool begins(const std::string& text, const std::string& with) { return text.rfind(with, 0) == 0; }

/// What has to be true of a request that was let in, said in another way than Access does.
void check_let_in(const RequestHead& head, bool beyond_loopback) {
  if (head.method != "GET" && head.method != "HEAD") FAIL("method " << head.method);
  std::string host;
  for (const char c : head.host) host += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  if (!beyond_loopback) {
    bool known = false;
    for (const std::string name : {"localhost", "127.0.0.1", "[::1]"})
      known = known || host == name ||
              (begins(host, name + ":") &&
               host.find_first_not_of("0123456789", name.size() + 1) == std::string::npos);
    if (!known) FAIL("host " << head.host);
  }
  if (beyond_loopback && head.cookie.find("lodestone=" + kFuzzToken) == std::string::npos)
    FAIL("cookie " << head.cookie);
  if (!head.origin.empty()) {
    std::string origin;
    for (const char c : head.origin) origin += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    const std::string bare = origin.substr(std::min(origin.size(), origin.find("://") + 3));
    const bool same = bare == host || bare + ":80" == host || bare == host + ":80" || bare + ":443" == host ||
                      bare == host + ":443";
    if (!same) FAIL("origin " << head.origin << " of host " << head.host);
  }
  if (head.upgrade && (head.fetch_site == "cross-site" || head.fetch_site == "same-site"))
    FAIL("site " << head.fetch_site);
}

void check_file(const console::Response& response, const std::set<std::string>& allowed) {
  if (!response.file) return;
  if (allowed.count(response.file->path()) == 0) FAIL("gives away " << response.file->path());
  if (response.first_byte + response.length_bytes > response.file->size_bytes()) FAIL("more than there is");
}

void check_headers(const console::Response& response) {
  for (const console::Header& header : console::headers_of(response))
    if ((header.name + header.value).find_first_of("\r\n") != std::string::npos)
      FAIL("a header of two lines");
}

}  // namespace

TEST_CASE("a spoiled request is let in by nobody's mistake, and sees no other files", "[soak]") {
  const tests::Soak soak("spoiled requests", 20'000, 10'000'000);
  const tests::TemporaryFolder folder;
  std::filesystem::create_directories(folder / "runs/a");
  std::filesystem::create_directories(folder / "recordings");
  std::set<std::string> allowed;
  for (const char* name : {"runs/a/report.html", "runs/a/with space.csv", "recordings/a.mp4"}) {
    tests::write_bytes(folder / name, "0123456789");
    allowed.insert(std::filesystem::canonical(folder / name).string());
  }
  tests::write_bytes(folder / "secret.txt", "secret");
  tests::write_bytes(folder / "runs/a/.hidden.txt", "hidden");
  std::filesystem::create_symlink(folder / "secret.txt", folder / "runs/out.txt");
  std::filesystem::create_symlink(folder.path(), folder / "runs/up");
  const console::ServedFiles files({{"/runs/", folder / "runs"}, {"/recordings/", folder / "recordings"}});
  const console::Pages pages = [&](const RequestHead& head) {
    return files.find(head).value_or(console::told(404, "there is none"));
  };
  const console::Access near_by(false, "");
  const console::Access from_afar(true, kFuzzToken);
  RequestSpoiler spoiler(soak.seed());
  RequestHead head;
  std::int64_t sockets = 0;
  std::int64_t found = 0;
  tests::fuzz(
      soak, [&] { head = spoiler.head(); },
      [&] {
        for (const bool beyond_loopback : {false, true}) {
          const console::Response response =
              console::answer(beyond_loopback ? from_afar : near_by, pages, head);
          const int status = response.status;
          check_headers(response);
          check_file(response, allowed);
          if (status == 101 || status == 200 || status == 206 || status == 404 || status == 416 ||
              status == 426)
            check_let_in(head, beyond_loopback);
          else if (status == 303 && head.target != "/?token=" + kFuzzToken)
            FAIL("the cookie for " << head.target);
          else if (status == 500)
            FAIL(response.body);
          sockets += status == 101 ? 1 : 0;
          found += response.file ? 1 : 0;
        }
      });
  CHECK(sockets > soak.count() / 200);
  CHECK(sockets < soak.count() / 4);
  CHECK(found > soak.count() / 200);
  CHECK(found < soak.count());
}
