// label -> [SKIN] -> how its surface takes the light
import {FrontSide, MeshPhysicalMaterial} from 'three';

/** Colours of how sure the surface is, from made up to measured; the page's legend has the same. */
const kRamp = `
vec3 ramp(float t) {
  vec3 low = vec3(0.638, 0.067, 0.105), middle = vec3(0.847, 0.423, 0.067), high = vec3(0.027, 0.342, 0.274);
  return t < 0.5 ? mix(low, middle, 2.0 * t) : mix(middle, high, 2.0 * t - 1.0);
}`;

/** Moist tissue: a soft body with a thin gloss; brighter, and as glass denser, where it turns away from the eye. */
export function makeSkin() {
  const skin = new MeshPhysicalMaterial({
    roughness: 0.62, metalness: 0, clearcoat: 0.35, clearcoatRoughness: 0.35, side: FrontSide,
    polygonOffset: true, polygonOffsetFactor: 1, polygonOffsetUnits: 1,  // contours lie in the surface
  });
  const measured = {value: 0};
  skin.userData.measured = measured;
  skin.onBeforeCompile = (shader) => {
    shader.uniforms.showMeasured = measured;
    shader.vertexShader = shader.vertexShader
        .replace('#include <common>', '#include <common>\nattribute float measured;\nvarying float vMeasured;')
        .replace('#include <begin_vertex>', '#include <begin_vertex>\nvMeasured = measured;');
    shader.fragmentShader = shader.fragmentShader
        .replace('#include <common>',
                 `#include <common>\nuniform float showMeasured;\nvarying float vMeasured;\n${kRamp}`)
        .replace('#include <color_fragment>',
                 '#include <color_fragment>\ndiffuseColor.rgb = mix(diffuseColor.rgb, ramp(vMeasured), showMeasured);')
        .replace('#include <opaque_fragment>', `
          float edge = pow(1.0 - abs(dot(normalize(vViewPosition), normal)), 3.0);
          outgoingLight += (diffuseColor.a < 1.0 ? 0.5 : 0.16) * edge * diffuseColor.rgb;
          if (diffuseColor.a < 1.0) diffuseColor.a = min(1.0, diffuseColor.a * (0.7 + 1.9 * edge));
          #include <opaque_fragment>`);
  };
  return skin;
}
