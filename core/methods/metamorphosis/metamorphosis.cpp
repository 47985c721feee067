#include "core/methods/metamorphosis/metamorphosis.h"

#include "core/methods/metamorphosis/contour_morph.h"
#include "core/methods/stack/layer_mesher.h"

namespace sonoloft {
namespace {

constexpr const char* kName = "metamorphosis";

Result<MethodSurfaces> run(const MethodInput& input) {
  const StackEnds ends = input.settings.at("ends") == "flat" ? StackEnds::flat : StackEnds::round;
  return metamorphosis(input.slices, {input.spacing_mm, ends, input.threads});
}

}  // namespace

Result<MethodSurfaces> metamorphosis(std::span<const TrackedSlice> slices, const MetamorphosisOptions& options) {
  const auto stack = make_stack(slices, kName);
  if (!stack) return tl::unexpected<Error>(stack.error());
  if (auto fits = check_size(stack->sizes_mm(), options.spacing_mm, stack->sections.size()); !fits)
    return tl::unexpected<Error>(fits.error());
  const ContourMorph morph(*stack, options);
  auto mesh = mesh_of(morph, stack->sections, options.threads);
  if (!mesh) return tl::unexpected<Error>(mesh.error());
  return MethodSurfaces{moved(std::move(*mesh), stack->stack_to_reference), morph.notes()};
}

Method metamorphosis_method() {
  return {kName,
          "two or more parallel slices, one or many labels",
          {{"ends",
            "how the first and the last slice are closed: flat there, or round half a slice distance beyond",
            "round",
            {"flat", "round"}}},
          run};
}

}  // namespace sonoloft
