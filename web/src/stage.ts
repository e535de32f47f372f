// The canvas: lit meshes as the server sends them, cameras, and drawing no more often than needed.
import * as THREE from 'three'
import { Antialias } from './antialias'
import { Chunks } from './chunks'
import { Pace } from './pace'
import type { Packet } from './packet'
import { disposeMaterial, recompile, shared, surfaceMaterials } from './surface'
import type { View } from './connection'

const kRestMilliseconds = 250
// Triangles: of larger meshes the smallest may be left out while something moves, or at rest.
const kLargeMoving = 150_000
const kLargeStill = 500_000
const kLightShare = 0.4 // of the time, that may go into frames that only show new light
const kStillMilliseconds = 700 // a frame of a large mesh at rest
const kFirstRate = 1000 // triangles in a millisecond, until it is known

function high(count: number, of: (i: number) => number): number {
  const values: number[] = []
  for (let i = 0; i < count; i += Math.max(1, Math.floor(count / 20000))) values.push(of(i))
  values.sort((a, b) => a - b)
  return values.length ? values[Math.floor(0.98 * (values.length - 1))] : 1
}

interface Drawable {
  geometry: THREE.BufferGeometry
  chunks: Chunks
}

export class Stage {
  readonly scene = new THREE.Scene()
  readonly camera = new THREE.PerspectiveCamera(45, 1, 0.01, 1000)
  readonly renderer: THREE.WebGLRenderer
  header: Record<string, any> | null = null
  epoch = 0
  version = 0
  bounds = new THREE.Box3(new THREE.Vector3(-1, -1, -1), new THREE.Vector3(1, 1, 1))
  frames = 0
  frameTimes: number[] = []
  beforeDraw: (seconds: number) => boolean = () => false
  afterDraw: () => void = () => {}
  onStruggle: () => void = () => {} // frames of a movement come too slowly

  private mesh: THREE.Mesh | null = null
  private whole: Drawable | null = null
  private simple: Drawable | null = null // fewer triangles, or the same
  private materials: [THREE.ShaderMaterial[], THREE.ShaderMaterial[]] = [[], []] // at rest, in a hurry
  private light: THREE.BufferAttribute | null = null
  private value: THREE.BufferAttribute | null = null
  private wanted = true
  private lastFrame = 0
  private lastMotion = 0
  private lastDrawn = 0
  private wasMoving = false // in the last frame
  private applied = 0 // resolution
  private drawn = 0 // triangles
  private inSight = 0
  private rate = kFirstRate
  private cost = 0 // milliseconds of the last frame
  private readonly fences: { sync: WebGLSync; since: number; triangles: number }[] = []
  private readonly pace = new Pace()
  private readonly antialias: Antialias

  constructor(readonly canvas: HTMLCanvasElement) {
    this.renderer = new THREE.WebGLRenderer({ canvas, antialias: false, preserveDrawingBuffer: true })
    this.antialias = new Antialias(this.renderer)
    this.renderer.outputColorSpace = THREE.LinearSRGBColorSpace // the shaders write sRGB themselves
    this.renderer.toneMapping = THREE.NoToneMapping
    this.renderer.setClearColor(0x000000)
    new ResizeObserver(() => this.resize()).observe(canvas)
    this.resize()
    requestAnimationFrame((time) => this.frame(time))
  }

  draw(): void {
    this.wanted = true
  }

  // Another mesh, shown at once with its first light.
  show(topology: Packet, light: Packet): void {
    const h = topology.header
    const geometry = new THREE.BufferGeometry()
    geometry.setAttribute('position', new THREE.BufferAttribute(topology.floats('positions'), 3))
    if (topology.has('uvs')) geometry.setAttribute('uv', new THREE.BufferAttribute(topology.floats('uvs'), 2))
    geometry.setIndex(new THREE.BufferAttribute(topology.words('indices'), 1))
    this.light = new THREE.BufferAttribute(new Uint32Array(h.vertices), 1)
    this.light.gpuType = THREE.IntType
    this.light.setUsage(THREE.DynamicDrawUsage)
    this.value = null
    geometry.setAttribute('light', this.light)
    const materials: typeof this.materials = [[], []]
    h.draws.forEach((d: any) => {
      const made = surfaceMaterials(h.materials[d.material], d.emits, () => this.draw())
      made.forEach((m, i) => materials[i].push(m))
    })
    this.bounds.set(new THREE.Vector3(...h.bounds[0]), new THREE.Vector3(...h.bounds[1]))
    this.dispose()
    this.materials = materials
    this.whole = { geometry, chunks: new Chunks(topology.words('chunks')) }
    this.simple = this.whole
    if (topology.has('simpleIndices')) {
      const simple = new THREE.BufferGeometry()
      for (const [name, attribute] of Object.entries(geometry.attributes)) simple.setAttribute(name, attribute)
      simple.setIndex(new THREE.BufferAttribute(topology.words('simpleIndices'), 1))
      this.simple = { geometry: simple, chunks: new Chunks(topology.words('simpleChunks')) }
    }
    this.mesh = new THREE.Mesh(geometry, materials[0])
    this.mesh.frustumCulled = false
    this.scene.add(this.mesh)
    // The first picture is a quick one.
    if (!this.header) this.lastMotion = this.lastFrame
    this.header = h
    this.epoch = h.epoch
    const sky = h.sky as number[]
    this.scene.background = Math.max(...sky) > 0 ? new THREE.Color(0x9fb4c8) : new THREE.Color(0x101214)
    const far = 20 * Math.max(1e-3, this.bounds.getSize(new THREE.Vector3()).length())
    this.camera.far = far
    this.camera.near = far / 40000
    this.camera.updateProjectionMatrix()
    this.update(light)
  }

  // New light for some of the vertices; false when it is that of another mesh.
  update(packet: Packet): boolean {
    if (packet.header.epoch !== this.epoch || !this.light) return false
    const ranges = packet.words('ranges')
    const light = packet.words('light')
    const target = this.light.array as Uint32Array
    let at = 0
    for (let i = 0; i < ranges.length; i += 2) {
      const [first, count] = [ranges[i], ranges[i + 1]]
      target.set(light.subarray(at, at + count), first)
      this.light.addUpdateRange(first, count)
      at += count
    }
    this.light.needsUpdate = true
    this.version = packet.header.version
    shared.lightScale.value = packet.header.scale
    this.draw()
    return true
  }

  // Other shaders: what is shown has changed, not only by how much.
  recompile(): void {
    this.materials.forEach(recompile)
    this.draw()
  }

  setValues(values: Float32Array): void {
    if (!this.mesh || values.length !== this.light?.count) return
    if (!this.value) {
      this.value = new THREE.BufferAttribute(new Float32Array(values.length), 1)
      for (const shape of [this.whole, this.simple]) shape?.geometry.setAttribute('value', this.value)
    }
    ;(this.value.array as Float32Array).set(values)
    this.value.needsUpdate = true
    this.draw()
  }

  // 98 % of the vertices have less illuminance than this, in the scene's unit.
  highIlluminance(): number {
    const light = (this.light?.array ?? new Uint32Array()) as Uint32Array
    return high(light.length, (i) => {
      const e = light[i]
      const scale = shared.lightScale.value * 2 ** ((e >>> 27) - 24)
      return (0.2126 * (e & 511) + 0.7152 * ((e >>> 9) & 511) + 0.0722 * ((e >>> 18) & 511)) * scale
    })
  }
  // The same of the values.
  highValue(): number {
    const values = (this.value?.array ?? new Float32Array()) as Float32Array
    return high(values.length, (i) => values[i])
  }

  setView(view: { position: number[]; forward: number[]; up: number[]; fov: number }): void {
    const position = new THREE.Vector3(...view.position)
    this.camera.position.copy(position)
    this.camera.up.set(0, 1, 0)
    if (Math.abs(view.forward[1]) > 0.999) this.camera.up.set(view.up[0], view.up[1], view.up[2])
    this.camera.lookAt(position.add(new THREE.Vector3(...view.forward)))
    this.camera.fov = (view.fov * 180) / Math.PI
    this.camera.updateProjectionMatrix()
    this.draw()
  }

  view(): View {
    const forward = this.camera.getWorldDirection(new THREE.Vector3())
    const up = new THREE.Vector3(0, 1, 0).applyQuaternion(this.camera.quaternion)
    return {
      position: this.camera.position.toArray(),
      forward: forward.toArray(),
      up: up.toArray(),
      fov: (this.camera.fov * Math.PI) / 180,
      width: Math.max(1, this.canvas.clientWidth),
      height: Math.max(1, this.canvas.clientHeight),
    }
  }

  // Through a point of the canvas, in its pixels.
  ray(x: number, y: number): { origin: number[]; direction: number[] } {
    const at = new THREE.Vector2(
      (2 * x) / this.canvas.clientWidth - 1,
      1 - (2 * y) / this.canvas.clientHeight,
    )
    const caster = new THREE.Raycaster()
    caster.setFromCamera(at, this.camera)
    return { origin: caster.ray.origin.toArray(), direction: caster.ray.direction.toArray() }
  }

  // All of the picture at once, however long it takes.
  finish(): void {
    this.render(1, false, Infinity)
    while (!this.antialias.isDone()) this.smooth()
  }

  async screenshot(): Promise<Blob> {
    this.finish()
    return new Promise((resolve, reject) =>
      this.canvas.toBlob((blob) => (blob ? resolve(blob) : reject(new Error('The picture could not be taken.')))),
    )
  }

  framesPerSecond(): number {
    const recent = this.frameTimes.slice(-30)
    return recent.length < 2 ? 0 : (1000 * (recent.length - 1)) / (recent[recent.length - 1] - recent[0])
  }

  private dispose(): void {
    if (!this.mesh) return
    this.scene.remove(this.mesh)
    this.whole?.geometry.dispose()
    this.simple?.geometry.dispose()
    this.materials.flat().forEach(disposeMaterial)
  }

  private resize(): void {
    this.camera.aspect = Math.max(1, this.canvas.clientWidth) / Math.max(1, this.canvas.clientHeight)
    this.camera.updateProjectionMatrix()
    this.applied = 0
    this.draw()
  }

  private applyResolution(resolution: number): void {
    if (this.applied === resolution) return
    this.applied = resolution
    this.renderer.setPixelRatio(Math.min(1.5, window.devicePixelRatio) * resolution)
    this.renderer.setSize(this.canvas.clientWidth, this.canvas.clientHeight, false)
  }

  private mayLeaveOut(hurried: boolean): boolean {
    const shape = hurried ? this.simple : this.whole
    return (shape?.geometry.index?.count ?? 0) > 3 * (hurried ? kLargeMoving : kLargeStill)
  }

  // Frames that the graphics card, or what stands for one, still has to draw; how long the others
  // took is known from then on.
  private underWay(): number {
    const gl = this.renderer.getContext() as WebGL2RenderingContext
    while (this.fences.length > 0) {
      const { sync, since, triangles } = this.fences[0]
      if (gl.clientWaitSync(sync, 0, 0) === gl.TIMEOUT_EXPIRED) break
      gl.deleteSync(sync)
      this.cost = Math.max(1, performance.now() - since)
      this.rate += 0.5 * (triangles / this.cost - this.rate)
      this.fences.shift()
    }
    return this.fences.length
  }

  private render(resolution: number, hurried: boolean, most: number): void {
    this.applyResolution(resolution)
    const shape = hurried ? this.simple : this.whole
    if (this.mesh && shape) {
      const chosen = shape.chunks.visible(this.camera, most)
      this.mesh.geometry = shape.geometry
      shape.geometry.groups = chosen.groups
      this.mesh.material = this.materials[hurried ? 1 : 0]
      this.drawn = chosen.drawn
      this.inSight = chosen.triangles
    }
    this.renderer.render(this.scene, this.camera)
    this.antialias.restart()
  }

  private smooth(): void {
    this.antialias.add(this.camera, () => this.renderer.render(this.scene, this.camera))
  }

  // What is to be drawn now: nothing when nothing has changed. While something moves, resolution and
  // small triangles are given up for pace; at rest the picture becomes whole again, then smooth.
  private step(time: number, moving: boolean): boolean {
    if (!this.mesh) return false
    const inQueue = this.underWay()
    if (inQueue > (this.mayLeaveOut(true) ? 0 : 1)) return false
    const still = time - this.lastMotion > kRestMilliseconds
    const since = time - this.lastDrawn
    if (!still) {
      if (!moving && !this.wanted) return false
      this.wanted = false
      this.render(this.pace.resolution(), true, this.mayLeaveOut(true) ? this.pace.mostTriangles() : Infinity)
      return true
    }
    const most = this.mayLeaveOut(false) ? this.rate * kStillMilliseconds : Infinity
    const unfinished = this.applied !== 1 || this.drawn < Math.min(this.inSight, most) / 1.5
    if (unfinished || (this.wanted && (inQueue === 0 && since > this.cost / kLightShare))) {
      this.wanted = false
      this.render(1, false, most)
      return true
    }
    if (this.wanted || inQueue > 0 || this.antialias.isDone() || since < Math.max(kRestMilliseconds, 2 * this.cost)) return false
    this.smooth()
    return true
  }

  private frame(time: number): void {
    requestAnimationFrame((next) => this.frame(next))
    const seconds = Math.min(0.1, (time - this.lastFrame) / 1000)
    this.lastFrame = time
    const moving = this.beforeDraw(seconds)
    if (moving) this.lastMotion = time
    if (!this.step(time, moving)) return
    if (moving && this.wasMoving && time - this.lastDrawn < 1000) this.pace.learn(time - this.lastDrawn, this.mayLeaveOut(true))
    if (moving && this.pace.isStruggling()) this.onStruggle()
    this.wasMoving = moving
    const gl = this.renderer.getContext() as WebGL2RenderingContext
    const sync = gl.fenceSync(gl.SYNC_GPU_COMMANDS_COMPLETE, 0)
    gl.flush()
    if (sync) this.fences.push({ sync, since: performance.now(), triangles: this.drawn })
    this.lastDrawn = time
    ++this.frames
    this.frameTimes.push(time)
    if (this.frameTimes.length > 240) this.frameTimes.splice(0, 120)
    this.afterDraw()
  }
}
