#include "episode_groups.h"

#include "lodestone/common/error.h"
#include "lodestone/data/episode_bytes.h"

namespace lodestone::data {
namespace {

using common::DataError;

Episode read_episode(hid_t root, const std::string& name, const RowLayout& layout, ArrayReader& reader,
                     const std::string& path) {
  const std::string place = path + ": " + name;
  const Handle group = open_group(root, name.c_str());
  if (!group.valid()) throw DataError(place + " cannot be opened");
  Episode episode;
  const auto s = static_cast<hsize_t>(state_size(layout.state));
  const std::size_t rows = reader.read(group.get(), "observations", s, episode.observations, place);
  const std::size_t steps =
      reader.read(group.get(), "actions", static_cast<hsize_t>(layout.action_size), episode.actions, place);
  reader.read(group.get(), "terminations", 1, episode.terminations, place);
  reader.read(group.get(), "truncations", 1, episode.truncations, place);
  reader.read(group.get(), "infos/zero_current", 1, episode.zero_current, place);
  if (rows == steps + 1 && episode.zero_current.size() == rows)
    episode.zero_current.erase(episode.zero_current.begin());  // the reset's
  if (rows != steps + 1 || episode.terminations.size() != steps || episode.truncations.size() != steps ||
      episode.zero_current.size() != steps)
    throw DataError(place + ": " + std::to_string(rows) + " observations do not fit " +
                    std::to_string(steps) +
                    " actions: T actions need T+1 observations and T flags of each kind");
  read_attribute(group.get(), "placements", episode.placements);  // absent where nobody counted them
  std::string expected;
  if (read_attribute(group.get(), "checksum", expected)) compare_checksum(episode, expected, place);
  return episode;
}

}  // namespace

std::vector<Episode> read_episode_groups(hid_t group, hsize_t others, const RowLayout& layout,
                                         ArrayReader& reader, const std::string& place) {
  H5G_info_t links{};
  if (H5Gget_info(group, &links) < 0) throw DataError(place + ": its list of episodes is damaged");
  std::vector<Episode> episodes;
  for (hsize_t i = 0; i < links.nlinks - others; ++i) {
    const std::string name = "episode_" + std::to_string(i);
    if (H5Lexists(group, name.c_str(), H5P_DEFAULT) <= 0)
      throw DataError(place + ": holds " + std::to_string(links.nlinks - others) + " groups, but " + name +
                      " is missing");
    episodes.push_back(read_episode(group, name, layout, reader, place));
  }
  return episodes;
}

}  // namespace lodestone::data
