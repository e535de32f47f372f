// What the solver works with, drawn over the light.
import * as THREE from 'three'
import type { Connection } from './connection'
import type { Packet } from './packet'
import type { Stage } from './stage'
import { viridis } from './colours'

export type Layer = 'none' | 'elements' | 'clusters' | 'links' | 'cut' | 'error' | 'features'
export const kLayers: Record<string, Layer> = {
  none: 'none',
  'element mesh': 'elements',
  'clusters by depth': 'clusters',
  'links of the probed element': 'links',
  'exact and averaged': 'cut',
  'estimated error': 'error',
  'feature mask': 'features',
}
export type ClusterColour = 'blockerSize' | 'extinction' | 'averaged'

export interface LayerLegend {
  title: string
  low: number
  high: number
  unit: string
}

const kExact = new THREE.Color(0xff8a3d)
const kAveraged = new THREE.Color(0x4db8ff)

const box = [
  [0, 1], [1, 3], [3, 2], [2, 0], [4, 5], [5, 7], [7, 6], [6, 4], [0, 4], [1, 5], [2, 6], [3, 7],
]

function boxLines(boxes: Float32Array, colour: (i: number) => THREE.Color): THREE.LineSegments {
  const n = boxes.length / 6
  const positions = new Float32Array(n * 24 * 3)
  const colours = new Float32Array(n * 24 * 3)
  let at = 0
  for (let i = 0; i < n; ++i) {
    const c = colour(i)
    for (const edge of box)
      for (const corner of edge) {
        for (let axis = 0; axis < 3; ++axis)
          positions[at + axis] = boxes[6 * i + (corner & (1 << axis) ? 3 : 0) + axis]
        colours.set([c.r, c.g, c.b], at)
        at += 3
      }
  }
  return lines(positions, colours)
}

function lines(positions: Float32Array, colours: Float32Array | null, opacity = 1): THREE.LineSegments {
  const geometry = new THREE.BufferGeometry()
  geometry.setAttribute('position', new THREE.BufferAttribute(positions, 3))
  if (colours) geometry.setAttribute('color', new THREE.BufferAttribute(colours, 3))
  const material = new THREE.LineBasicMaterial({
    vertexColors: colours !== null,
    color: colours ? 0xffffff : 0x58e0b0,
    transparent: opacity < 1,
    opacity,
  })
  const made = new THREE.LineSegments(geometry, material)
  made.frustumCulled = false
  return made
}

const scaled = (t: number): THREE.Color => new THREE.Color().setRGB(...viridis(t))

// Logarithmic, as sizes and densities span decades.
function logScale(values: Float32Array): { low: number; high: number; at: (v: number) => number } {
  let [low, high] = [Infinity, 0]
  for (const v of values)
    if (v > 0) {
      low = Math.min(low, v)
      high = Math.max(high, v)
    }
  if (!(high > 0)) return { low: 0, high: 1, at: () => 0 }
  const span = Math.log(high / low) || 1
  return { low, high, at: (v) => (v > 0 ? Math.log(v / low) / span : 0) }
}

export class Layers {
  layer: Layer = 'none'
  depth = 3
  clusterColour: ClusterColour = 'blockerSize'
  pixels = 12
  element: number | null = null
  legend: LayerLegend | null = null
  onValues: () => void = () => {}
  onText: (text: string) => void = () => {}
  onFail: (error: Error) => void = () => {}
  private drawn: THREE.Object3D | null = null
  private running = false
  private again = false

  constructor(
    private readonly stage: Stage,
    private readonly connection: Connection,
    private readonly mask: HTMLCanvasElement,
  ) {}

  clear(): void {
    if (this.drawn) {
      this.stage.scene.remove(this.drawn)
      this.drawn.traverse((o) => {
        const l = o as THREE.LineSegments
        l.geometry?.dispose()
        ;(l.material as THREE.Material | undefined)?.dispose()
      })
      this.drawn = null
    }
    this.mask.hidden = true
    this.legend = null
    this.stage.draw()
  }

  // Asks anew; at most one question is under way.
  async refresh(): Promise<void> {
    if (this.running) {
      this.again = true
      return
    }
    this.running = true
    try {
      await this.load()
    } catch (error) {
      this.clear()
      this.onFail(error as Error)
    }
    this.running = false
    if (this.again) {
      this.again = false
      void this.refresh()
    }
  }

  private async load(): Promise<void> {
    const layer = this.layer
    if (layer === 'none') return this.clear()
    if ((layer === 'links' || layer === 'cut') && this.element === null) {
      this.clear()
      this.onText('Click a surface to pick its element.')
      return
    }
    const packet = await this.connection.layer({
      kind: layer,
      ...(layer === 'clusters' ? { depth: this.depth } : {}),
      ...(layer === 'links' || layer === 'cut' ? { element: this.element } : {}),
      ...(layer === 'features' ? { view: this.stage.view(), pixels: this.pixels } : {}),
    })
    if (layer !== this.layer) return
    this.clear()
    this[layer](packet)
    if (this.drawn) this.stage.scene.add(this.drawn)
    this.stage.draw()
  }

  private elements(packet: Packet): void {
    this.drawn = lines(packet.floats('lines'), null, 0.55)
    const one = packet.header.shownOneOf
    this.onText(`${packet.header.cells.toLocaleString('en')} cells${one > 1 ? `, one of ${one} drawn` : ''}`)
  }

  private clusters(packet: Packet): void {
    const values = packet.floats(this.clusterColour)
    const count = values.length.toLocaleString('en')
    if (this.clusterColour === 'averaged') {
      this.drawn = boxLines(packet.floats('boxes'), (i) => (values[i] > 0 ? kAveraged : kExact))
      const averaged = values.reduce((n, v) => n + (v > 0 ? 1 : 0), 0)
      this.onText(`${count} clusters: ${averaged} averaged (blue), the others exact (orange)`)
      return
    }
    const scale = logScale(values)
    this.drawn = boxLines(packet.floats('boxes'), (i) => scaled(scale.at(values[i])))
    const isSize = this.clusterColour === 'blockerSize'
    this.legend = {
      title: isSize ? 'BSIZE' : 'Extinction',
      low: scale.low,
      high: scale.high,
      unit: isSize ? 'm' : '1/m',
    }
    this.onText(`${count} clusters at depth ${packet.header.depth}`)
  }

  private links(packet: Packet): void {
    const values = packet.floats('values')
    const scale = logScale(values)
    const colours = new Float32Array(values.length * 6)
    values.forEach((v, i) => {
      const c = scaled(scale.at(v))
      colours.set([c.r, c.g, c.b, c.r, c.g, c.b], 6 * i)
    })
    this.drawn = lines(packet.floats('lines'), colours)
    this.legend = { title: 'Irradiance by link', low: scale.low, high: scale.high, unit: 'W/m²' }
    this.onText(`The ${values.length} strongest ${packet.header.sampled ? 'sampled' : 'refined'} links`)
  }

  private cut(packet: Packet): void {
    const averaged = packet.floats('averaged')
    const group = new THREE.Group()
    group.add(boxLines(packet.floats('boxes'), (i) => (averaged[i] > 0 ? kAveraged : kExact)))
    const ray = packet.floats('lines')
    group.add(lines(ray, new Float32Array([1, 1, 1, 1, 1, 1])))
    this.drawn = group
    const n = averaged.reduce((sum, v) => sum + (v > 0 ? 1 : 0), 0)
    this.onText(`Ray to the brightest lamp: ${n} clusters averaged (blue), ${averaged.length - n} parts exact (orange)`)
  }

  private error(packet: Packet): void {
    if (packet.header.epoch !== this.stage.epoch) {
      this.again = true
      return
    }
    this.stage.setValues(packet.floats('values'))
    this.onValues()
    this.onText(
      packet.header.measured
        ? 'Cells against a final gather, relative to the mean irradiance or the local one'
        : 'By the error bounds of the refined links',
    )
  }

  private features(packet: Packet): void {
    const { width, height } = packet.header as { width: number; height: number }
    const classes = packet.words('classes')
    this.mask.width = width
    this.mask.height = height
    const image = new ImageData(width, height)
    classes.forEach((c, i) => {
      const rgba = c === 2 ? [255, 80, 80, 150] : c === 1 ? [80, 160, 255, 130] : [0, 0, 0, 0]
      image.data.set(rgba, 4 * i)
    })
    this.mask.getContext('2d')!.putImageData(image, 0, 0)
    this.mask.hidden = false
    this.onText(`Shadow features wider than ${this.pixels} pixels (red), smaller shadows (blue)`)
  }
}
