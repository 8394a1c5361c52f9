#include "haptolith/core/platform/shared_library.h"

#include <gmock/gmock.h>

#include <functional>
#include <string>

#include "haptolith/core/error.h"

namespace haptolith {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::StartsWith;

std::string failureOf(const std::function<void()>& work) {
  try {
    work();
  } catch (const Failure& failure) {
    return failure.what();
  }
  return "it worked";
}

TEST(SharedLibrary, ItsFunctionsCanBeCalledAlsoWhenItIsGone) {
  double (*cosine)(double) = nullptr;
  {
    const SharedLibrary mathematics("libm.so.6");
    EXPECT_EQ(mathematics.path(), "libm.so.6");
    cosine = mathematics.symbol("cos");
  }
  EXPECT_EQ(cosine(0), 1);
}

TEST(SharedLibrary, OneThatIsNotThereIsNamed) {
  EXPECT_THAT(failureOf([] { SharedLibrary("libno_such_thing.so.7"); }),
              AllOf(StartsWith("cannot load libno_such_thing.so.7: cannot open"), HasSubstr("No such file")));
}

TEST(SharedLibrary, AFunctionThatItLacksIsNamed) {
  const SharedLibrary mathematics("libm.so.6");
  void (*nothing)() = nullptr;
  EXPECT_THAT(failureOf([&] { nothing = mathematics.symbol("no_such_function"); }),
              AllOf(HasSubstr("libm.so.6"), HasSubstr("no_such_function")));
  EXPECT_EQ(nothing, nullptr);
}

}  // namespace
}  // namespace haptolith
