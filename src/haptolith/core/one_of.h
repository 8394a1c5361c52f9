#pragma once

namespace haptolith {

/// Handlers for std::visit, one for each type that a variant may hold.
template <class... Handlers>
struct OneOf : Handlers... {
  using Handlers::operator()...;
};
template <class... Handlers>
OneOf(Handlers...) -> OneOf<Handlers...>;

}  // namespace haptolith
