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
  scale: { value: 1 }, // full scale of false colour
  factor: { value: 1 }, // from the scene's unit to the one shown
  toneMappingExposure: { value: 1 },
}

// What is compiled in: a processor that stands for a graphics card walks through every branch of a
// shader, whichever is taken.
const defines = { SHOW: 0, TONE_MAP: 1 }

// True: other programs are needed.
function define(name: keyof typeof defines, value: number): boolean {
  const changed = defines[name] !== value
  defines[name] = value
  return changed
}
export const setShow = (show: Show) => define('SHOW', kShows.indexOf(show))
export const setToneMap = (map: ToneMap) => define('TONE_MAP', kToneMaps.indexOf(map))
export function recompile(materials: THREE.ShaderMaterial[]): void {
  for (const m of materials) {
    Object.assign(m.defines, defines)
    m.needsUpdate = true
  }
}

// IN_VERTICES: shown as what the vertices show, mixed in between; else by the light in each pixel.
const shading = `
#define IN_VERTICES (HURRIED == 1 && TEXTURED == 0 && SHOW != 3)
uniform vec3 reflectance;
uniform vec3 emission;
uniform float alpha;
uniform float exposure;
uniform float scale;
uniform float factor;
vec3 toSrgb(vec3 c) {
  vec3 x = clamp(c, 0., 1.);
  return mix(1.055 * pow(x, vec3(1. / 2.4)) - .055, 12.92 * x, vec3(lessThanEqual(x, vec3(.0031308))));
}
#if SHOW == 0
vec3 shade(vec3 irradiance, vec3 base, vec3 glow) {
  vec3 c = exposure * (base * reflectance * irradiance * ${1 / Math.PI} + emission * glow);
#if TONE_MAP == 1
  c = AgXToneMapping(c);
#elif TONE_MAP == 2
  c = NeutralToneMapping(c);
#endif
  return toSrgb(c);
}
#elif SHOW == 1
${viridisGlsl}
vec3 shade(vec3 irradiance, vec3 base, vec3 glow) {
  return viridis(dot(irradiance, vec3(.2126, .7152, .0722)) * factor / scale);
}
#elif SHOW == 2
${viridisGlsl}
vec3 shade(vec3 value, vec3 base, vec3 glow) {
  return viridis(value.x / scale);
}
#endif`

// `light` is RGB9_E5 (src/halflight/view/shared_exponent.h).
const vertexShader = `
#include <common>
#include <tonemapping_pars_fragment>
${shading}
in uint light;
in float value;
uniform float lightScale;
out vec3 vShown; // irradiance, a value or, IN_VERTICES, the colour
#if TEXTURED == 1
out vec2 vUv;
#endif
#if SHOW == 3
out vec3 vPosition;
#endif
void main() {
#if SHOW == 2
  vShown = vec3(value);
#else
  // 2^(e - 24), put together from its bits
  float size = lightScale * uintBitsToFloat(((light >> 27u) + 103u) << 23u);
  vShown = vec3(float(light & 511u), float((light >> 9u) & 511u), float((light >> 18u) & 511u)) * size;
#endif
#if IN_VERTICES
  vShown = shade(vShown, vec3(1.), vec3(1.));
#endif
  vec4 seen = modelViewMatrix * vec4(position, 1.);
#if TEXTURED == 1
  vUv = uv;
#endif
#if SHOW == 3
  vPosition = seen.xyz;
#endif
  gl_Position = projectionMatrix * seen;
}`

const fragmentShader = `
#include <common>
#include <tonemapping_pars_fragment>
${shading}
in vec3 vShown;
#if TEXTURED == 1
in vec2 vUv;
uniform sampler2D map;
uniform sampler2D emissionMap;
uniform float alphaCutoff;
#endif
#if SHOW == 3
in vec3 vPosition;
#endif
layout(location = 0) out vec4 shown;
void main() {
  vec3 base = vec3(1.), glow = vec3(1.);
  float opacity = alpha;
#if TEXTURED == 1
  vec4 texel = texture(map, vUv);
  base = texel.rgb;
  glow = texture(emissionMap, vUv).rgb;
  opacity *= texel.a;
  if (alphaCutoff >= 0. && opacity < alphaCutoff) discard;
  if (alphaCutoff >= 0.) opacity = 1.;
#endif
#if IN_VERTICES
  shown = vec4(vShown, opacity);
#elif SHOW == 3
  vec3 n = normalize(cross(dFdx(vPosition), dFdy(vPosition)));
  float facing = abs(dot(n, normalize(vPosition)));
  shown = vec4(toSrgb((.15 + .85 * facing) * mix(vec3(.6), reflectance * base, .5)), opacity);
#else
  shown = vec4(shade(vShown, base, glow), opacity);
#endif
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

// Two materials that share what they show: one for a picture that stands, and one that is drawn in
// a hurry.
export function surfaceMaterials(material: any, emits: boolean, onLoad: () => void): [THREE.ShaderMaterial, THREE.ShaderMaterial] {
  const isMask = material.alphaMode === 'mask'
  const alpha = material.alphaMode === 'opaque' && material.alpha > 0.99 ? 1 : material.alpha
  const isClear = !isMask && (material.alphaMode === 'blend' || alpha < 1)
  const glows = emits && material.emissionTexture
  const isTextured = Boolean(material.texture || glows || isMask)
  const uniforms: Record<string, THREE.IUniform> = {
    ...shared,
    reflectance: { value: new THREE.Vector3(...material.reflectance) },
    emission: { value: new THREE.Vector3(...(emits ? material.emission : [0, 0, 0])) },
    alpha: { value: alpha },
  }
  if (isTextured) {
    uniforms.map = { value: material.texture ? loadTexture(material.texture, onLoad) : whiteTexture() }
    uniforms.emissionMap = { value: glows ? loadTexture(material.emissionTexture, onLoad) : whiteTexture() }
    uniforms.alphaCutoff = { value: isMask ? material.alphaCutoff : -1 }
  }
  const make = (hurried: boolean) =>
    new THREE.ShaderMaterial({
      glslVersion: THREE.GLSL3,
      vertexShader,
      fragmentShader,
      defines: { ...defines, TEXTURED: Number(isTextured), HURRIED: Number(hurried) },
      uniforms,
      transparent: isClear,
      depthWrite: !isClear,
    })
  return [make(false), make(true)]
}

export function disposeMaterial(material: THREE.ShaderMaterial): void {
  for (const name of ['map', 'emissionMap']) {
    const texture = material.uniforms[name]?.value
    if (texture && texture !== white) texture.dispose()
  }
  material.dispose()
}
