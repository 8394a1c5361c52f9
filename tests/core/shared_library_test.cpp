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

#ifdef _WIN32
constexpr const char* kMathLibrary = "msvcrt.dll";
constexpr const char* kWhyNot = "odule not found";  // Wine's words; Windows' have another case and more of them
#else
constexpr const char* kMathLibrary = "libm.so.6";
constexpr const char* kWhyNot = "cannot open shared object file: No such file";
#endif

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
    const SharedLibrary mathematics(kMathLibrary);
    EXPECT_EQ(mathematics.path(), kMathLibrary);
    cosine = mathematics.symbol("cos");
  }
  EXPECT_EQ(cosine(0), 1);
}

TEST(SharedLibrary, OneThatIsNotThereIsNamed) {
  EXPECT_THAT(failureOf([] { SharedLibrary("libno_such_thing.so.7"); }),
              AllOf(StartsWith("cannot load libno_such_thing.so.7: "), HasSubstr(kWhyNot)));
}

TEST(SharedLibrary, AFunctionThatItLacksIsNamed) {
  const SharedLibrary mathematics(kMathLibrary);
  void (*nothing)() = nullptr;
  EXPECT_THAT(failureOf([&] { nothing = mathematics.symbol("no_such_function"); }),
              AllOf(HasSubstr(kMathLibrary), HasSubstr("no_such_function")));
  EXPECT_EQ(nothing, nullptr);
}

}  // namespace
}  // namespace haptolith
