// Values under the cursor.
const kLuxPerWatt = 179 // lm/W, the convention of Radiance

export const luminance = (c: number[]) => 0.2126 * c[0] + 0.7152 * c[1] + 0.0722 * c[2]
export const toLux = (c: number[]) => kLuxPerWatt * luminance(c)
export const kUnits = { 'W/m²': 1, lux: kLuxPerWatt }
export type UnitName = keyof typeof kUnits

export function short(value: number): string {
  if (!Number.isFinite(value)) return '–'
  const size = Math.abs(value)
  if (size === 0) return '0'
  if (size >= 1e5 || size < 1e-3) return value.toExponential(2)
  return value.toPrecision(3).replace(/(\.\d*?)0+$/, '$1').replace(/\.$/, '')
}
const rgb = (c: number[]) => c.map(short).join(' · ')

function row(list: HTMLElement, term: string, text: string): void {
  const dt = document.createElement('dt')
  const dd = document.createElement('dd')
  dt.textContent = term
  dd.textContent = text
  list.append(dt, dd)
}

export function showProbe(section: HTMLElement, p: any, unit: UnitName, pinned: boolean): void {
  section.hidden = !p?.hit
  if (!p?.hit) return
  const list = document.createElement('dl')
  const value = p.irradiance ? short(kUnits[unit] * luminance(p.irradiance)) : '–'
  row(list, 'E', `${value} ${unit}`)
  if (p.irradiance) row(list, 'E, RGB', rgb(p.irradiance))
  if (p.direct) row(list, 'direct', rgb(p.direct))
  if (p.element) row(list, 'radiosity B', rgb(p.element.radiosity))
  row(list, 'reflectance', rgb(p.reflectance))
  if (p.emission && Math.max(...p.emission) > 0) row(list, 'emission L', rgb(p.emission))
  row(list, 'at', `${p.position.map((v: number) => v.toFixed(3)).join(', ')} m`)
  row(list, 'on', [p.nodeName, p.material].filter(Boolean).join(', ') || `node ${p.node}`)
  if (p.element) {
    row(list, 'element', `${p.element.id}, ${short(100 * p.element.size)} cm, depth ${p.element.depth}`)
    row(list, 'links', `${p.element.links} ${p.element.sampled ? 'sampled' : 'refined'}`)
    if (p.element.importance < 1) row(list, 'importance', short(p.element.importance))
  }
  const title = document.createElement('h2')
  title.textContent = pinned ? 'Probe, read as a sensor' : 'Probe'
  section.replaceChildren(title, list)
}
