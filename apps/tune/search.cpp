// SPDX-License-Identifier: Apache-2.0
#include "apps/tune/search.hpp"

#include <algorithm>

#include "base/quantile.hpp"
#include "engine/gradient/gradient_operator.hpp"

namespace palpate {
namespace {

constexpr int kTriedNs[] = {1, 2, 3, 5, 8, 13, 21};
constexpr int kTriedWindows[] = {8, 12, 16, 24, 32};  // [voxel]
// Sizes in voxels. Below 0.7 voxel a Gaussian removes little noise; a wider one moves a curved surface more.
constexpr const char* kTriedFilters[] = {"", "gaussian:0.7", "gaussian:1"};
constexpr const char* kMoreFilters[] = {"gaussian:1.5", "gaussian:2", "median:1", "median:1 gaussian:1"};
constexpr const char* kTriedSigma = "1";  // of an operator that smooths [voxel]

constexpr std::size_t kKeptOfAxis = 2;

template <typename Value>
void addNew(std::vector<Value>& values, const Value& value) {
  if (std::ranges::find(values, value) == values.end()) values.push_back(value);
}

class Search {
 public:
  Search(const Goal& goal, const SearchSpace& space, const std::function<Trial(const Candidate&)>& feel)
      : goal_(goal), space_(space), feel_(feel) {}

  Found run() {
    feel(space_.own);
    Candidate truest = truestOfTheScene();
    if (!(found_.base.contact_share > 0)) return std::move(found_);
    const auto filters = truestTwo(truest, &Candidate::filter, space_.filters, space_.more_filters);
    truest.filter = filters.front();
    const auto operators = truestTwo(truest, &Candidate::gradient_operator, space_.operators, {});
    truest.gradient_operator = operators.front();
    const std::vector<int> windows = cheapestWindows(truest);
    feelAll(filters, operators, windows);
    const Candidate middle = best();
    feelAround(middle);
    const std::vector<std::size_t> finalists = measureAgain();
    if (!finalists.empty()) {
      const Candidate first = found_.trials[finalists.front()].candidate;  // a copy: feeling moves the trials
      if (first != middle) feelAround(first);
    }
    pick(finalists);
    return std::move(found_);
  }

 private:
  // All but filter and operator, which are the scene's, as true as they can be. Floats may not fit where halves do.
  Candidate truestOfTheScene() {
    Candidate truest = space_.own;
    truest.n = space_.ns.front();
    truest.window_edge = space_.windows.back();
    for (const std::string& samples : space_.samples) {
      truest.samples = samples;
      found_.base = feel(truest);
      if (found_.base.impossible.empty()) break;
    }
    return truest;
  }

  // Each candidate once, by two runs of which the quicker counts: what else the machine does only adds to a time.
  Trial feel(const Candidate& candidate) {
    const auto known = std::ranges::find(found_.trials, candidate, &Trial::candidate);
    if (known != found_.trials.end()) return *known;
    Trial trial = feel_(candidate);
    if (trial.impossible.empty()) {
      const Trial again = feel_(candidate);
      if (again.impossible.empty()) trial.loop_us = std::min(trial.loop_us, again.loop_us);
      keepWorse(trial, again);
    }
    found_.trials.push_back(std::move(trial));
    return found_.trials.back();
  }

  // The truest value of a choice and, if it is another one, the scene's.
  std::vector<std::string> truestTwo(Candidate candidate, std::string Candidate::*choice,
                                     const std::vector<std::string>& values, const std::vector<std::string>& more) {
    const std::string& own = values.front();
    std::string best = own;
    double least_N = std::numeric_limits<double>::infinity();
    const auto tryAll = [&](const std::vector<std::string>& list) {
      for (const std::string& value : list) {
        candidate.*choice = value;
        const Trial trial = feel(candidate);
        if (!holdsContact(trial, found_.base) || !(trial.error_N < least_N * (1 - kSameError))) continue;
        least_N = trial.error_N;
        best = value;
      }
    };
    tryAll(values);
    if (best != own && !more.empty()) tryAll(more);
    return best == own ? std::vector{own} : std::vector{best, own};
  }

  std::vector<int> cheapestWindows(Candidate candidate) {
    const double largest_N = feel(candidate).error_N;
    std::vector<Trial> usable;
    for (const int edge : space_.windows) {
      candidate.window_edge = edge;
      const Trial trial = feel(candidate);
      const bool as_true = !(trial.error_N > largest_N * (1 + kSameError) + 1e-6);
      if (as_true && holdsContact(trial, found_.base)) usable.push_back(trial);
    }
    std::ranges::stable_sort(usable, {}, &Trial::loop_us);
    std::vector<int> edges;
    for (const Trial& trial : usable) {
      if (edges.size() < kKeptOfAxis) edges.push_back(trial.candidate.window_edge);
    }
    if (edges.empty()) edges.push_back(space_.windows.back());
    return edges;
  }

  // One engine serves all n, so they come next to each other.
  void feelAll(const std::vector<std::string>& filters, const std::vector<std::string>& operators,
               const std::vector<int>& windows) {
    for (const std::string& filter : filters) {
      for (const std::string& gradient_operator : operators) {
        for (const std::string& samples : space_.samples) {
          for (const int window : windows) {
            for (const int n : space_.ns) feel({gradient_operator, filter, samples, n, window});
          }
        }
      }
    }
  }

  [[nodiscard]] Candidate best() const {
    const std::vector<std::size_t> order = ranked(goal_, found_.trials, found_.base, space_.own);
    return found_.trials[order.empty() ? nearestTo(goal_, found_.trials, found_.base) : order.front()].candidate;
  }

  // Every other value of each choice. A choice that was made early may be another one beside the rest, and the reasons
  // for the pick compare it with these.
  void feelAround(const Candidate& middle) {
    const auto vary = [&](auto Candidate::*choice, const auto& values) {
      Candidate candidate = middle;
      for (const auto& value : values) {
        candidate.*choice = value;
        feel(candidate);
      }
    };
    vary(&Candidate::gradient_operator, space_.operators);
    vary(&Candidate::filter, space_.filters);
    vary(&Candidate::window_edge, space_.windows);
    vary(&Candidate::samples, space_.samples);
    vary(&Candidate::n, space_.ns);
  }

  // Those that may meet the goal, the best first: without any, a budget's quickest, whose times may be off by chance.
  [[nodiscard]] std::vector<std::size_t> finalists() const {
    std::vector<std::size_t> finalists = ranked(goal_, found_.trials, found_.base, space_.own);
    if (finalists.empty() && goal_.kind == Goal::Kind::kBudget) {
      for (std::size_t i = 0; i < found_.trials.size(); ++i) {
        if (holdsContact(found_.trials[i], found_.base)) finalists.push_back(i);
      }
      std::ranges::stable_sort(finalists, {}, [&](std::size_t i) { return found_.trials[i].loop_us; });
    }
    if (finalists.size() > kFinalists) finalists.resize(kFinalists);
    return finalists;
  }

  // The finalists that still meet the goal, the best first.
  std::vector<std::size_t> measureAgain() {
    const std::vector<std::size_t> places = finalists();
    std::vector<std::vector<double>> times_us(places.size());
    for (int round = 0; round < kRounds; ++round) {
      for (std::size_t i = 0; i < places.size(); ++i) {
        Trial& trial = found_.trials[places[i]];
        if (!trial.impossible.empty()) continue;
        const Trial once_more = feel_(trial.candidate);
        if (once_more.impossible.empty()) times_us[i].push_back(once_more.loop_us);
        keepWorse(trial, once_more);
      }
    }
    std::vector<Trial> again;
    std::vector<std::size_t> order;
    for (std::size_t i = 0; i < places.size(); ++i) {
      if (!times_us[i].empty()) found_.trials[places[i]].loop_us = median(times_us[i]);
      again.push_back(found_.trials[places[i]]);
    }
    for (const std::size_t i : ranked(goal_, again, found_.base, space_.own)) order.push_back(places[i]);
    return order;
  }

  void pick(const std::vector<std::size_t>& finalists) {
    found_.picks = finalists;
    for (const std::size_t i : ranked(goal_, found_.trials, found_.base, space_.own)) {
      if (std::ranges::find(finalists, i) == finalists.end()) found_.picks.push_back(i);
    }
    found_.as_good = countAsGood(goal_, found_.trials, found_.base);
  }

  const Goal& goal_;
  const SearchSpace& space_;
  const std::function<Trial(const Candidate&)>& feel_;
  Found found_;
};

}  // namespace

SearchSpace searchSpace(const Scene& scene, const SpaceRequest& request) {
  SearchSpace space;
  space.own = candidateOf(scene);
  space.filters = {scene.filter};
  space.operators = {scene.gradient_operator};
  if (request.filters_and_operators) {
    for (const char* filter : kTriedFilters) addNew(space.filters, std::string(filter));
    for (const char* filter : kMoreFilters) addNew(space.more_filters, std::string(filter));
    for (const GradientKind& kind : gradientKinds())
      addNew(space.operators, std::string(kind.name) + (kind.parameter.empty() ? "" : std::string(":") + kTriedSigma));
  }
  space.samples = {"float", "half"};
  space.ns = {scene.plane_renewal_ticks};
  if (request.renews_planes) {
    for (const int n : kTriedNs) addNew(space.ns, n);
  }
  space.windows = {scene.window_edge};
  for (const int edge : kTriedWindows) addNew(space.windows, edge);
  std::ranges::sort(space.ns);
  std::ranges::sort(space.windows);
  const auto holds_all = [&](int edge) { return edge >= request.longest_edge; };
  const auto first_of_all = std::ranges::find_if(space.windows, holds_all);
  if (first_of_all != space.windows.end()) space.windows.erase(std::next(first_of_all), space.windows.end());
  return space;
}

std::size_t mostRuns(const SearchSpace& space) {
  const auto kept = [](std::size_t values) { return std::min(values, kKeptOfAxis); };
  const std::size_t alone =
      1 + space.filters.size() + space.more_filters.size() + space.operators.size() - 1 + space.windows.size() - 1;
  const std::size_t combined = kept(space.filters.size() + space.more_filters.size()) * kept(space.operators.size()) *
                               kept(space.windows.size()) * space.samples.size() * space.ns.size();
  const std::size_t around =
      space.operators.size() + space.filters.size() + space.windows.size() + space.samples.size() + space.ns.size() - 5;
  return 2 * (alone + combined + 2 * around) + kFinalists * kRounds;
}

Found search(const Goal& goal, const SearchSpace& space, const std::function<Trial(const Candidate&)>& feel) {
  return Search(goal, space, feel).run();
}

}  // namespace palpate
