// The canvas: lit meshes as the server sends them, cameras, and drawing no more often than needed.
import * as THREE from 'three'
import { Packet } from './packet'
import { shared, surfaceMaterial } from './surface'
import type { View } from './connection'

const kFrameMilliseconds = 33
const kCoarsest = 0.5 // of the full resolution while the camera moves
const kRestMilliseconds = 250
const kLargeMesh = 500_000 // triangles: of larger meshes only the largest are drawn, as many as go
const kMovingMilliseconds = 80 // a frame of a large mesh that moves
const kStillMilliseconds = 700
const kFirstRate = 1000 // triangles in a millisecond, until it is known
const kFewestDrawn = 50_000

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

  private mesh: THREE.Mesh | null = null
  private light: THREE.BufferAttribute | null = null
  private value: THREE.BufferAttribute | null = null
  private wanted = true
  private lastFrame = 0
  private lastMotion = 0
  private resolution = 1
  private applied = 0
  private rate = kFirstRate
  private drawn = 0 // triangles of a large mesh
  private drawing: { fence: WebGLSync; since: number } | null = null

  constructor(readonly canvas: HTMLCanvasElement) {
    this.renderer = new THREE.WebGLRenderer({ canvas, antialias: true, preserveDrawingBuffer: true })
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
  show(topology: Packet, light: Packet, onTexture: () => void): void {
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
    const materials: THREE.Material[] = []
    h.draws.forEach((d: any, i: number) => {
      materials.push(surfaceMaterial(h.materials[d.material], d.emits, () => (onTexture(), this.draw())))
      geometry.addGroup(3 * d.first, 3 * d.count, i)
    })
    this.bounds.set(new THREE.Vector3(...h.bounds[0]), new THREE.Vector3(...h.bounds[1]))
    geometry.boundingSphere = this.bounds.getBoundingSphere(new THREE.Sphere())
    this.dispose()
    this.mesh = new THREE.Mesh(geometry, materials)
    this.mesh.frustumCulled = false
    this.scene.add(this.mesh)
    this.header = h
    this.epoch = h.epoch
    this.drawn = 0
    this.chooseTriangles(true)
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
    this.light.clearUpdateRanges()
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

  setValues(values: Float32Array): void {
    if (!this.mesh || values.length !== this.light?.count) return
    if (!this.value) {
      this.value = new THREE.BufferAttribute(new Float32Array(values.length), 1)
      this.mesh.geometry.setAttribute('value', this.value)
    }
    ;(this.value.array as Float32Array).set(values)
    this.value.needsUpdate = true
    this.draw()
  }

  // 98 % of the vertices have less illuminance than this, in the scene's unit.
  highIlluminance(): number {
    const light = (this.light?.array ?? new Uint32Array()) as Uint32Array
    const values: number[] = []
    const step = Math.max(1, Math.floor(light.length / 20000))
    for (let i = 0; i < light.length; i += step) {
      const e = light[i]
      const scale = shared.lightScale.value * 2 ** ((e >>> 27) - 24)
      values.push((0.2126 * (e & 511) + 0.7152 * ((e >>> 9) & 511) + 0.0722 * ((e >>> 18) & 511)) * scale)
    }
    values.sort((a, b) => a - b)
    return values.length ? values[Math.floor(0.98 * (values.length - 1))] : 1
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

  screenshot(): Promise<Blob> {
    this.applyResolution(1)
    this.renderer.render(this.scene, this.camera)
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
    this.mesh.geometry.dispose()
    for (const m of this.mesh.material as THREE.ShaderMaterial[]) {
      for (const name of ['map', 'emissionMap'])
        if (!(m.uniforms[name].value instanceof THREE.DataTexture)) m.uniforms[name].value.dispose()
      m.dispose()
    }
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

  private isLarge(): boolean {
    return (this.header?.triangles ?? 0) > kLargeMesh
  }

  // Of a large mesh, whether the last frame has left the graphics card or what stands for one; how
  // long it took tells how many triangles the next may have.
  private isDrawn(): boolean {
    if (!this.drawing) return true
    const gl = this.renderer.getContext() as WebGL2RenderingContext
    if (gl.clientWaitSync(this.drawing.fence, 0, 0) === gl.TIMEOUT_EXPIRED) return false
    gl.deleteSync(this.drawing.fence)
    const milliseconds = Math.max(1, performance.now() - this.drawing.since)
    this.rate += 0.5 * (this.drawn / milliseconds - this.rate)
    this.drawing = null
    return true
  }

  // Triangles come by size, the largest of each material first. False: as many as the last time.
  private chooseTriangles(moving: boolean): boolean {
    if (!this.isLarge() || !this.mesh) return false
    const all = this.header!.triangles as number
    const budget = this.rate * (moving ? kMovingMilliseconds : kStillMilliseconds)
    const wanted = Math.min(all, Math.max(kFewestDrawn, budget))
    // At rest more is drawn when it is worth it.
    if (!moving && this.drawn >= Math.min(all, wanted / 1.5)) return false
    if (moving && this.drawn <= wanted && wanted < 1.2 * this.drawn) return false
    this.drawn = wanted
    this.mesh.geometry.groups.forEach((g, i) => (g.count = 3 * Math.ceil((wanted / all) * this.header!.draws[i].count)))
    return true
  }

  // While something moves, resolution is given up for pace; at rest the picture is whole again.
  private frame(time: number): void {
    requestAnimationFrame((next) => this.frame(next))
    const seconds = Math.min(0.1, (time - this.lastFrame) / 1000)
    this.lastFrame = time
    const moving = this.beforeDraw(seconds)
    if (moving) {
      if (time - this.lastMotion < 100) {
        const slow = 1000 * seconds > 1.2 * kFrameMilliseconds
        const fast = 1000 * seconds < 0.6 * kFrameMilliseconds
        if (slow) this.resolution = Math.max(kCoarsest, this.resolution * 0.8)
        else if (fast) this.resolution = Math.min(1, this.resolution * 1.05)
      }
      this.lastMotion = time
    }
    const atRest = time - this.lastMotion > kRestMilliseconds
    const resolution = atRest ? 1 : Math.round(this.resolution * 8) / 8
    if (!this.isDrawn()) return
    const more = this.chooseTriangles(!atRest)
    if (!this.wanted && !moving && this.applied === resolution && !more) return
    this.wanted = false
    this.applyResolution(resolution)
    this.renderer.render(this.scene, this.camera)
    if (this.isLarge()) {
      const gl = this.renderer.getContext() as WebGL2RenderingContext
      const fence = gl.fenceSync(gl.SYNC_GPU_COMMANDS_COMPLETE, 0)
      gl.flush()
      if (fence) this.drawing = { fence, since: performance.now() }
    }
    ++this.frames
    this.frameTimes.push(time)
    if (this.frameTimes.length > 240) this.frameTimes.splice(0, 120)
    this.afterDraw()
  }
}
