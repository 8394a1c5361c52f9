#include "haptolith/study/protocol/button_answer.h"

#include <gtest/gtest.h>

namespace haptolith {
namespace {

TEST(ButtonAnswer, AShortPressIsTheLeftAnswerWhenItEnds) {
  ButtonAnswer buttons;
  buttons.ask();
  EXPECT_EQ(buttons.step(0, 0), std::nullopt);
  EXPECT_EQ(buttons.step(1, 0.1), std::nullopt);
  EXPECT_EQ(buttons.step(1, 0.5), std::nullopt);
  EXPECT_EQ(buttons.step(0, 0.6), 0);
  EXPECT_EQ(buttons.step(0, 0.7), std::nullopt);
}

TEST(ButtonAnswer, ALongPressIsTheRightAnswerOnce) {
  ButtonAnswer buttons;
  (void)buttons.step(0, 0);
  (void)buttons.step(1, 1);
  EXPECT_EQ(buttons.step(1, 1.61), 1);
  EXPECT_EQ(buttons.step(1, 3), std::nullopt);
  EXPECT_EQ(buttons.step(0, 4), std::nullopt);
}

TEST(ButtonAnswer, TheSecondButtonIsTheRightAnswerAtOnce) {
  ButtonAnswer buttons;
  (void)buttons.step(0, 0);
  EXPECT_EQ(buttons.step(2, 1), 1);
  EXPECT_EQ(buttons.step(2, 2), std::nullopt);
}

TEST(ButtonAnswer, WhatIsDownWhenSomethingIsAskedDoesNotCount) {
  ButtonAnswer buttons;
  (void)buttons.step(0, 0);
  (void)buttons.step(1, 1);
  buttons.ask();
  EXPECT_EQ(buttons.step(1, 5), std::nullopt);
  EXPECT_EQ(buttons.step(0, 6), std::nullopt);
  (void)buttons.step(1, 7);
  EXPECT_EQ(buttons.step(0, 7.1), 0);
}

}  // namespace
}  // namespace haptolith
