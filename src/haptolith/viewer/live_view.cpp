#include "haptolith/viewer/live_view.h"

#include <fmt/format.h>

#include <algorithm>
#include <exception>
#include <filesystem>
#include <utility>

#include "haptolith/bed/measure/contact_load.h"
#include "haptolith/core/error.h"
#include "haptolith/core/overloaded.h"
#include "haptolith/core/plain_text.h"
#include "haptolith/viewer/messages.h"

namespace haptolith {

namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

constexpr auto kBetweenStatus = 250ms;
constexpr auto kRateOver = 1s;

/// However much clients ask for, the rest of the main thread's work has its turn.
constexpr auto kLongestRound = 2ms;
constexpr int kMostInARound = 256;

/// Contact forces take some microseconds a particle to work out; no more than this share of the time goes to them.
constexpr double kShareForLoads = 0.2;

/// Whether a hand in the soil feels another force after this.
bool changesWhatIsFelt(const Command& asked) {
  return std::holds_alternative<command::Change>(asked) || std::holds_alternative<command::ToolFile>(asked) ||
         std::holds_alternative<command::Reset>(asked) || std::holds_alternative<command::Level>(asked) ||
         std::holds_alternative<command::Coarser>(asked) || std::holds_alternative<command::Undo>(asked);
}

/// The number of a tool. The message has no names of tools: a participant of a study might read them.
std::size_t toolNamed(const SceneFile& scene_file, const std::optional<std::string>& name) {
  if (!name) {
    return 0;
  }
  const std::vector<std::string_view> names = toolNames(scene_file);
  const auto found = std::ranges::find(names, *name);
  if (found == names.end()) {
    throw InvalidParameter("tool", inQuotes(*name), "the name of a tool in this scene");
  }
  return static_cast<std::size_t>(found - names.begin());
}

}  // namespace

LiveView::LiveView(Session& session, const WebServerOptions& options, std::string_view version, Recorder recorder,
                   Extension extension, Clients clients)
    : session_(session),
      recorder_(std::move(recorder)),
      extension_(std::move(extension)),
      clients_(clients),
      board_(helloMessages(version, clients == Clients::kLookOn, options.takes_uploads)),
      server_(options, board_),
      space_(shownSpace(session.shown().bed, session.surface())) {}

void LiveView::handleMessages() {
  const Clock::time_point until = Clock::now() + kLongestRound;
  WebServer::Event event;
  for (int i = 0; i < kMostInARound && !session_.done() && Clock::now() < until && server_.takeEvent(event); ++i) {
    if (event.kind == WebServer::Event::Kind::kJoined && extension_.joined) {
      extension_.joined(event.client, event.entrance);
    }
    if (event.kind == WebServer::Event::Kind::kLeft) {
      releaseToolsOf(event.client);
      coloured_by_force_.erase(event.client);
      if (extension_.left) {
        extension_.left(event.client);
      }
    }
    if (event.kind != WebServer::Event::Kind::kMessage) {
      continue;
    }
    const ClientMessage message = parseClientMessage(event.text);
    const std::string refused = answer(event.client, message, event.text);
    if (message.wants_reply) {
      server_.send(event.client, replyMessage(message.id, refused));
    }
  }
}

/// Does what a message asks for; returns why not, empty when it is done.
std::string LiveView::answer(std::uint32_t client, const ClientMessage& message, std::string_view text) {
  try {
    if (message.for_guest) {
      return extension_.handle ? extension_.handle(client, text) : "no study is running";
    }
    if (!message.command) {
      return message.refused;
    }
    if (std::string refused = refusal(client, message); !refused.empty()) {
      if (std::holds_alternative<command::Hold>(*message.command)) {
        releaseToolsOf(client);
      }
      return refused;
    }
    carryOut(client, *message.command);
  } catch (const InvalidParameter& error) {
    return error.what();
  } catch (const Failure& error) {
    return error.what();
  } catch (const std::exception& error) {  // no thread or no memory: a client's request must not end a run
    return fmt::format("not possible now: {}", error.what());
  }
  return {};
}

/// Why a command that makes sense may not be carried out now; empty: it may.
std::string LiveView::refusal(std::uint32_t client, const ClientMessage& message) const {
  const Command& asked = *message.command;
  if (clients_ == Clients::kLookOn && !std::holds_alternative<command::Colour>(asked)) {
    return "view only: the program was started with --read-only";
  }
  if (std::string refused = extension_.refuse ? extension_.refuse(client, asked) : ""; !refused.empty()) {
    return refused;
  }
  if (changesWhatIsFelt(asked) && !message.confirmed && session_.personFeels()) {
    throw RefusedAction(
        "confirmed",
        fmt::format("not confirmed: a user holds the haptic device ({}); confirm the change", session_.deviceName()));
  }
  return {};
}

void LiveView::carryOut(std::uint32_t client, const Command& asked) {
  scene_changed_ = scene_changed_ || !std::holds_alternative<command::Hold>(asked);
  std::visit(
      Overloaded{[&](const command::Hold& hold) {
                   const std::size_t tool = freeTool(client, hold.tool);
                   session_.hold(hold.scene_T_tool, tool);
                   holders_[tool] = client;
                 },
                 [&](const command::Release& release) {
                   const auto held = holders_.find(toolNamed(session_.sceneFile(), release.tool));
                   if (held != holders_.end() && held->second == client) {
                     session_.release(held->first);
                     holders_.erase(held);
                   }
                 },
                 [&](const command::Play& play) {
                   const std::size_t tool = freeTool(client, play.tool);
                   holders_.erase(tool);
                   session_.play(play.motion, tool);
                 },
                 [&](const command::Change& change) { session_.change(change.change); },
                 [&](const command::ToolFile& file) {
                   ToolMeshSource source = file.source;
                   source.bytes = server_.takeUpload(file.upload);
                   if (source.bytes == nullptr) {
                     throw RefusedAction("upload", "the uploaded file is not available any more: upload it again");
                   }
                   session_.takeToolMesh(std::move(source));
                 },
                 [&](const command::Reset&) { session_.reset(); }, [&](const command::Level&) { session_.level(); },
                 [&](const command::Coarser&) { session_.coarsen(); }, [&](const command::Undo&) { session_.undo(); },
                 [&](const command::Pause&) {
                   session_.pause();
                   releaseTools();
                 },
                 [&](const command::Resume&) { session_.resume(); },
                 [&](const command::Step& step) { session_.advance(step.ticks); },
                 [&](const command::Speed& speed) { session_.setSpeed(speed.factor); },
                 [&](const command::Record& record) {
                   if (!recorder_.start) {
                     throw Failure("recording is not available here");
                   }
                   (void)recordingNow();  // one that ends before the next status
                   record.on ? recorder_.start() : recorder_.stop();
                   (void)recordingNow();
                 },
                 [&](const command::Colour& colour) {
                   if (colour.by_force) {
                     coloured_by_force_.insert(client);
                   } else {
                     coloured_by_force_.erase(client);
                   }
                 }},
      asked);
}

void LiveView::releaseTools() {
  for (const auto& [tool, client] : std::exchange(holders_, {})) {
    session_.release(tool);
  }
}

void LiveView::releaseToolsOf(std::uint32_t client) {
  std::erase_if(holders_, [&](const auto& held) {
    if (held.second == client) {
      session_.release(held.first);
    }
    return held.second == client;
  });
}

/// Number of a tool that no other client holds.
std::size_t LiveView::freeTool(std::uint32_t client, const std::optional<std::string>& name) const {
  const std::size_t tool = toolNamed(session_.sceneFile(), name);
  if (const auto held = holders_.find(tool); held != holders_.end() && held->second != client) {
    throw Failure("another client controls the tool");
  }
  return tool;
}

std::vector<BesideTool> LiveView::besideTools() const {
  std::vector<BesideTool> tools;
  if (showsEveryTool(session_.shown())) {
    for (std::size_t tool = 0; tool < session_.tools(); ++tool) {
      const auto held = holders_.find(tool);
      tools.push_back({session_.held(tool), held == holders_.end() ? 0 : held->second});
    }
  }
  return tools;
}

void LiveView::show(bool newer, bool changed) {
  const Clock::time_point now = Clock::now();
  if (changed || scene_changed_) {
    showScene();
    scene_changed_ = false;
  }
  if (newer && scene_shown_ == session_.scenes()) {
    const SceneSnapshot& snapshot = session_.snapshot();
    if (coloured_by_force_.empty()) {
      loads_n_.clear();
    } else if (now >= loads_at_) {
      loads_n_ = contactLoads(session_.shown().bed, snapshot.position);
      loads_at_ = now + std::chrono::duration_cast<Clock::duration>((Clock::now() - now) / kShareForLoads);
    }
    board_.setPicture(
        snapshot,
        {.wanted = session_.held(), .held = holders_.contains(0), .load_n = loads_n_, .tools = besideTools()});
  }
  if (now >= status_at_) {
    status_at_ = now + kBetweenStatus;
    showStatus();
    newer = true;
  }
  if (newer || changed) {
    server_.notify();
  }
}

void LiveView::showScene() {
  if (scene_shown_ == session_.scenes()) {
    board_.setScene(sceneMessages(session_, space_));
    return;
  }
  scene_shown_ = session_.scenes();
  space_ = shownSpace(session_.shown().bed, session_.surface());
  loads_n_.clear();
  board_.setScene(sceneMessages(session_, space_), scene_shown_, session_.snapshot().position.size(), space_);
}

/// Name of the file that is being written; one that is finished may be downloaded.
std::string LiveView::recordingNow() {
  std::string now = recorder_.name ? recorder_.name() : "";
  const std::string before = std::exchange(recording_, now);
  std::error_code error;
  if (before != now && std::filesystem::is_regular_file(before, error)) {
    recorded_ = std::filesystem::absolute(before);
    server_.offer(recorded_);
  }
  return now;
}

void LiveView::showStatus() {
  const Clock::time_point now = Clock::now();
  const std::string recording = recordingNow();
  const std::uint64_t ticks = session_.snapshot().ticks;
  if (now - rate_at_ >= kRateOver) {
    const double elapsed_s = std::chrono::duration<double>(now - rate_at_).count();
    rate_hz_ = static_cast<double>(ticks - rate_ticks_) / elapsed_s;
    rate_at_ = now;
    rate_ticks_ = ticks;
  }
  board_.setStatus(
      statusMessages(session_, {.rate_hz = rate_hz_,
                                .clients = server_.clients(),
                                .held_by = holders_.contains(0) ? std::optional(holders_.at(0)) : std::nullopt,
                                .recording = recording,
                                .recorded = recorded_,
                                .robot = robot_ ? &*robot_ : nullptr}));
}

}  // namespace haptolith
