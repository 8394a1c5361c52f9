#pragma once

namespace haptolith {

/// Handlers for std::visit, one for each type that a variant may hold.
template <class... Handlers>
struct Overloaded : Handlers... {
  using Handlers::operator()...;
};
template <class... Handlers>
Overloaded(Handlers...) -> Overloaded<Handlers...>;

}  // namespace haptolith
