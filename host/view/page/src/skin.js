// label -> [SKIN] -> how its surface takes the light
import {FrontSide, MeshPhysicalMaterial} from 'three';

/** Colours from made up or far to measured or near; the page's legend has the same. */
const kRamp = `
uniform float told, near_mm;
varying float vMeasured, vDistance;
vec3 ramp(float t) {
  vec3 low = vec3(0.638, 0.067, 0.105), middle = vec3(0.847, 0.423, 0.067), high = vec3(0.027, 0.342, 0.274);
  return t < 0.5 ? mix(low, middle, 2.0 * t) : mix(middle, high, 2.0 * t - 1.0);
}`;

/**
 * Moist tissue: a soft body with a thin gloss; brighter, and as glass denser, where it turns away from the eye.
 * @param near_mm  {value}: up to there a slice is near; at four times that it is as far as the colours tell
 */
export function makeSkin(near_mm) {
  const skin = new MeshPhysicalMaterial({
    roughness: 0.62, metalness: 0, clearcoat: 0.35, clearcoatRoughness: 0.35, side: FrontSide,
    polygonOffset: true, polygonOffsetFactor: 1, polygonOffsetUnits: 1,  // contours lie in the surface
  });
  const told = {value: 0};
  skin.userData.told = told;
  skin.onBeforeCompile = (shader) => {
    Object.assign(shader.uniforms, {told, near_mm});
    shader.vertexShader = shader.vertexShader
        .replace('#include <common>', `#include <common>
          attribute float measured, quarters;
          varying float vMeasured, vDistance;`)
        .replace('#include <begin_vertex>', `#include <begin_vertex>
          vMeasured = measured;
          vDistance = quarters / 4.0;`);
    shader.fragmentShader = shader.fragmentShader
        .replace('#include <common>', `#include <common>\n${kRamp}`)
        .replace('#include <color_fragment>', `#include <color_fragment>
          float sure = told < 1.5 ? vMeasured : clamp((4.0 - vDistance / near_mm) / 3.0, 0.0, 1.0);
          diffuseColor.rgb = mix(diffuseColor.rgb, ramp(sure), min(told, 1.0));
          if (told > 1.5) diffuseColor.a = mix(1.0, diffuseColor.a, 0.3 + 0.7 * sure);  // what is far shows as glass, too`)
        .replace('#include <opaque_fragment>', `
          float edge = pow(1.0 - abs(dot(normalize(vViewPosition), normal)), 3.0);
          outgoingLight += (diffuseColor.a < 1.0 ? 0.5 : 0.16) * edge * diffuseColor.rgb;
          if (diffuseColor.a < 1.0) diffuseColor.a = min(1.0, diffuseColor.a * (0.7 + 1.9 * edge));
          #include <opaque_fragment>`);
  };
  return skin;
}
