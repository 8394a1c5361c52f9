#include "haptolith/haptics/loop/shown_scene.h"

namespace haptolith {

namespace {

SceneSnapshot firstSnapshot(const Scene& scene) {
  SceneSnapshot snapshot;
  const Bed& bed = scene.bed();
  snapshot.position.assign(bed.state().position.begin(),
                           bed.state().position.begin() + static_cast<std::ptrdiff_t>(bed.particles()));
  snapshot.stones = bed.stones().poses();
  for (std::size_t group = 0; group < bed.state().rested.size(); ++group) {
    snapshot.asleep.push_back(bed.state().asleep(group) ? 1 : 0);
  }
  snapshot.copied_at.fill(bed.changes());
  snapshot.awake = bed.awake();
  snapshot.tools.resize(scene.tools());
  return snapshot;
}

}  // namespace

ShownScene::ShownScene(Scene& shown) : scene(shown), snapshots(firstSnapshot(shown)) {}

}  // namespace haptolith
