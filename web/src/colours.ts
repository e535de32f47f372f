// Viridis (van der Walt and Smith 2015), as output/false_colour.cpp: dark blue at 0, yellow at 1. A
// fit of degree six in sRGB, the same in the shader.
const kFit = [
  [0.2777273272234177, 0.005407344544966578, 0.3340998053353061],
  [0.1050930431085774, 1.404613529898575, 1.384590162594685],
  [-0.3308618287255563, 0.214847559468213, 0.09509516302823659],
  [-4.634230498983486, -5.799100973351585, -19.33244095627987],
  [6.228269936347081, 14.17993336680509, 56.69055260068105],
  [4.776384997670288, -13.74514537774601, -65.35303263337234],
  [-5.435455855934631, 4.645852612178535, 26.3124352495832],
]

export function viridis(t: number): [number, number, number] {
  const x = Math.min(1, Math.max(0, t))
  const channel = (k: number) =>
    Math.min(1, Math.max(0, kFit.reduceRight((sum, c) => sum * x + c[k], 0)))
  return [channel(0), channel(1), channel(2)]
}

export const viridisGlsl = `
vec3 viridis(float t) {
  float x = clamp(t, 0., 1.);
  return clamp(${kFit
    .map((c) => `vec3(${c.map((v) => v.toFixed(9)).join(', ')})`)
    .map((c, i, all) => (i + 1 < all.length ? `(${c} + x * ` : c))
    .join('')}${')'.repeat(kFit.length - 1)}, 0., 1.);
}`

// Linear channels from an sRGB colour as pages write it, and back.
export function fromHex(hex: string): number[] {
  return [1, 3, 5].map((at) => {
    const c = parseInt(hex.slice(at, at + 2), 16) / 255
    return c <= 0.04045 ? c / 12.92 : ((c + 0.055) / 1.055) ** 2.4
  })
}
export function toHex(linear: number[]): string {
  const byte = (x: number) => Math.round(255 * (x <= 0.0031308 ? 12.92 * x : 1.055 * x ** (1 / 2.4) - 0.055))
  return `#${linear.map((x) => byte(Math.min(1, Math.max(0, x))).toString(16).padStart(2, '0')).join('')}`
}
