// How lit surfaces are shown: radiance by exposure and tone map, or a value as false colour.
import * as THREE from 'three'
import { viridisGlsl } from './colours'

export type Show = 'light' | 'irradiance' | 'error' | 'shape'
export type ToneMap = 'none' | 'agx' | 'neutral'
const kShows: Show[] = ['light', 'irradiance', 'error', 'shape']
const kToneMaps: ToneMap[] = ['none', 'agx', 'neutral']

// Shared by all materials: one change is seen by all.
export const shared = {
  exposure: { value: 1 },
  lightScale: { value: 1 }, // of the packed light
  toneMap: { value: 1 },
  show: { value: 0 },
  scale: { value: 1 }, // full scale of false colour
  factor: { value: 1 }, // from the scene's unit to the one shown
  toneMappingExposure: { value: 1 },
}

export const setShow = (show: Show) => (shared.show.value = kShows.indexOf(show))
export const setToneMap = (map: ToneMap) => (shared.toneMap.value = kToneMaps.indexOf(map))

// `light` is RGB9_E5 (src/halflight/view/shared_exponent.h).
const vertexShader = `
in uint light;
in float value;
uniform float lightScale;
// Interpolated inside triangles only: at outlines, values run on beyond them would be black.
centroid out vec3 vIrradiance;
centroid out float vValue;
centroid out vec2 vUv;
out vec3 vPosition;
void main() {
  float scale = lightScale * exp2(float(light >> 27u) - 24.);
  vIrradiance = vec3(float(light & 511u), float((light >> 9u) & 511u), float((light >> 18u) & 511u)) * scale;
  vValue = value;
  vUv = uv;
  vec4 seen = modelViewMatrix * vec4(position, 1.);
  vPosition = seen.xyz;
  gl_Position = projectionMatrix * seen;
}`

const fragmentShader = `
#include <common>
#include <tonemapping_pars_fragment>
centroid in vec3 vIrradiance;
centroid in float vValue;
centroid in vec2 vUv;
in vec3 vPosition;
uniform vec3 reflectance;
uniform vec3 emission;
uniform sampler2D map;
uniform sampler2D emissionMap;
uniform float alpha;
uniform float alphaCutoff;
uniform float exposure;
uniform int toneMap;
uniform int show;
uniform float scale;
uniform float factor;
layout(location = 0) out vec4 shown;
${viridisGlsl}
vec3 toSrgb(vec3 c) {
  vec3 x = clamp(c, 0., 1.);
  return mix(1.055 * pow(x, vec3(1. / 2.4)) - .055, 12.92 * x, vec3(lessThanEqual(x, vec3(.0031308))));
}
void main() {
  vec4 base = texture(map, vUv);
  float opacity = alpha * base.a;
  if (alphaCutoff >= 0. && opacity < alphaCutoff) discard;
  if (alphaCutoff >= 0.) opacity = 1.;
  if (show == 1) {
    shown = vec4(viridis(dot(vIrradiance, vec3(.2126, .7152, .0722)) * factor / scale), opacity);
    return;
  }
  if (show == 2) {
    shown = vec4(viridis(vValue / scale), opacity);
    return;
  }
  vec3 rho = reflectance * base.rgb;
  if (show == 3) {
    vec3 n = normalize(cross(dFdx(vPosition), dFdy(vPosition)));
    float facing = abs(dot(n, normalize(vPosition)));
    shown = vec4(toSrgb((.15 + .85 * facing) * mix(vec3(.6), rho, .5)), opacity);
    return;
  }
  vec3 radiance = rho * vIrradiance * ${1 / Math.PI} + emission * texture(emissionMap, vUv).rgb;
  vec3 c = exposure * radiance;
  if (toneMap == 1) c = AgXToneMapping(c);
  if (toneMap == 2) c = NeutralToneMapping(c);
  shown = vec4(toSrgb(c), opacity);
}`

let white: THREE.DataTexture | null = null
function whiteTexture(): THREE.DataTexture {
  if (!white) {
    white = new THREE.DataTexture(new Uint8Array([255, 255, 255, 255]), 1, 1)
    white.needsUpdate = true
  }
  return white
}

const kWraps: Record<string, THREE.Wrapping> = {
  repeat: THREE.RepeatWrapping,
  mirror: THREE.MirroredRepeatWrapping,
  clamp: THREE.ClampToEdgeWrapping,
}

// Textures arrive after the first picture.
function loadTexture(wish: any, onLoad: () => void): THREE.Texture {
  const texture = new THREE.TextureLoader().load(`api/texture?id=${wish.id}`, onLoad)
  texture.flipY = false
  texture.wrapS = kWraps[wish.wrapU]
  texture.wrapT = kWraps[wish.wrapV]
  texture.colorSpace = THREE.SRGBColorSpace
  return texture
}

export function surfaceMaterial(material: any, emits: boolean, onLoad: () => void): THREE.ShaderMaterial {
  const isMask = material.alphaMode === 'mask'
  const alpha = material.alphaMode === 'opaque' && material.alpha > 0.99 ? 1 : material.alpha
  const isClear = !isMask && (material.alphaMode === 'blend' || alpha < 1)
  const made = new THREE.ShaderMaterial({
    glslVersion: THREE.GLSL3,
    vertexShader,
    fragmentShader,
    uniforms: {
      ...shared,
      reflectance: { value: new THREE.Vector3(...material.reflectance) },
      emission: { value: new THREE.Vector3(...(emits ? material.emission : [0, 0, 0])) },
      map: { value: whiteTexture() },
      emissionMap: { value: whiteTexture() },
      alpha: { value: isMask ? material.alpha : alpha },
      alphaCutoff: { value: isMask ? material.alphaCutoff : -1 },
    },
    transparent: isClear,
    depthWrite: !isClear,
  })
  if (material.texture) made.uniforms.map.value = loadTexture(material.texture, onLoad)
  if (emits && material.emissionTexture)
    made.uniforms.emissionMap.value = loadTexture(material.emissionTexture, onLoad)
  return made
}
