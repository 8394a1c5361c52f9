#include "haptolith/viewer/board.h"

#include <gtest/gtest.h>

#include "haptolith/viewer/frame.h"

namespace haptolith {
namespace {

const FrameSpace kSpace{Vec3(-1, -1, 0), Vec3(1, 1, 1)};

SceneSnapshot snapshotOf(std::size_t particles) {
  SceneSnapshot snapshot;
  snapshot.position.resize(particles);
  snapshot.asleep.resize(particles / kGroup + 1);
  return snapshot;
}

std::string nextText(Board& board, Board::Seen& seen) {
  const auto message = board.next(5, seen);
  return message ? (message->binary ? "frame" : *message->bytes) : "nothing";
}

TEST(Board, ShowsANewcomerEverythingInOrderAndThenNothing) {
  Board board(R"({"client":"$client"})");
  board.setScene({"scene", "nameless"}, 1, 10, kSpace);
  board.setPicture(snapshotOf(10), {});
  board.setStatus("status");
  Board::Seen seen;
  EXPECT_EQ(nextText(board, seen), R"({"client":5})");
  EXPECT_EQ(nextText(board, seen), "scene");
  EXPECT_EQ(nextText(board, seen), "status");
  EXPECT_EQ(nextText(board, seen), "frame");
  EXPECT_EQ(nextText(board, seen), "nothing");
  board.setScene({"scene", "nameless"});
  EXPECT_EQ(nextText(board, seen), "nothing") << "it is what it was";
}

TEST(Board, WhoIsNotToBeToldWhatItIsSeesTheSameScenesWithoutNames) {
  Board board("hello");
  board.setScene({"P1", "some soil"}, 1, 10, kSpace);
  Board::Seen seen{.nameless = true};
  EXPECT_EQ(nextText(board, seen), "hello");
  EXPECT_EQ(nextText(board, seen), "some soil");
  board.setScene({"P2", "some soil"});
  EXPECT_EQ(nextText(board, seen), "some soil");
}

TEST(Board, WhoIsSoSlowThatThereIsAlwaysANewerPictureIsToldTheStatusAllTheSame) {
  Board board("hello");
  board.setScene({"scene", "nameless"}, 1, 10, kSpace);
  Board::Seen seen;
  int told = 0;
  for (int i = 0; i < 40; ++i) {
    board.setPicture(snapshotOf(10), {});
    if (i % 10 == 0) {
      board.setStatus("status");
    }
    told += nextText(board, seen) == "status" ? 1 : 0;
  }
  EXPECT_EQ(told, 4);
}

TEST(Board, OnlyTheNewestOfEachIsShown) {
  Board board("hello");
  Board::Seen seen;
  EXPECT_EQ(nextText(board, seen), "hello");
  EXPECT_EQ(nextText(board, seen), "nothing") << "there is no scene yet";
  board.setScene({"old", "nameless"}, 1, 10, kSpace);
  board.setScene({"new", "nameless"});
  board.setStatus("earlier");
  board.setStatus("later");
  EXPECT_EQ(nextText(board, seen), "new");
  EXPECT_EQ(nextText(board, seen), "later");
  board.setPicture(snapshotOf(10), {});
  board.setPicture(snapshotOf(10), {});
  EXPECT_EQ(nextText(board, seen), "frame");
  EXPECT_EQ(nextText(board, seen), "nothing");
}

TEST(Board, AnotherSceneIsToldBeforeItsFirstPicture) {
  Board board("hello");
  Board::Seen seen;
  board.setScene({"first", "nameless"}, 1, 10, kSpace);
  board.setPicture(snapshotOf(10), {});
  while (board.next(1, seen)) {
  }
  board.setScene({"second", "nameless"}, 2, 20, kSpace);
  board.setPicture(snapshotOf(20), {});
  EXPECT_EQ(nextText(board, seen), "second");
  const auto frame = board.next(1, seen);
  ASSERT_TRUE(frame && frame->binary);
  EXPECT_EQ(frame->bytes->size(), 128U + 8 + 20 * 8) << "all of it";
}

}  // namespace
}  // namespace haptolith
