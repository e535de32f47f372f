// Turning around the scene and walking through it, by mouse, touch and keys.
import * as THREE from 'three'
import { OrbitControls } from 'three/addons/controls/OrbitControls.js'
import type { Stage } from './stage'

export type Mode = 'orbit' | 'walk'

const kTurnPerPixel = 0.004 // radians
const kKeys: Record<string, [number, number, number]> = {
  KeyW: [0, 0, 1],
  ArrowUp: [0, 0, 1],
  KeyS: [0, 0, -1],
  ArrowDown: [0, 0, -1],
  KeyA: [-1, 0, 0],
  KeyD: [1, 0, 0],
  KeyQ: [0, -1, 0],
  KeyE: [0, 1, 0],
}
const kTurns: Record<string, number> = { ArrowLeft: 1, ArrowRight: -1 }

export class Motion {
  mode: Mode = 'orbit'
  enabled = true
  onRest: () => void = () => {}
  readonly orbit: OrbitControls
  private readonly down = new Set<string>()
  private readonly pointers = new Map<number, { x: number; y: number }>()
  private pinch = 0
  private moved = false
  private wasMoving = false

  constructor(private readonly stage: Stage) {
    this.orbit = new OrbitControls(stage.camera, stage.canvas)
    this.orbit.enableDamping = true
    this.orbit.dampingFactor = 0.15
    this.orbit.addEventListener('change', () => (this.moved = true))
    const canvas = stage.canvas
    canvas.addEventListener('keydown', (e) => this.key(e, true))
    window.addEventListener('keyup', (e) => this.key(e, false))
    window.addEventListener('blur', () => this.down.clear())
    canvas.addEventListener('pointerdown', (e) => this.press(e))
    canvas.addEventListener('pointermove', (e) => this.drag(e))
    for (const end of ['pointerup', 'pointercancel'] as const)
      canvas.addEventListener(end, (e) => (this.pointers.delete(e.pointerId), (this.pinch = 0)))
    canvas.addEventListener('wheel', (e) => this.wheel(e), { passive: false })
    stage.beforeDraw = (seconds) => this.step(seconds)
  }

  setMode(mode: Mode): void {
    this.mode = mode
    this.orbit.enabled = this.enabled && mode === 'orbit'
    if (mode === 'orbit') this.aim()
  }

  // While something else is dragged.
  setEnabled(enabled: boolean): void {
    this.enabled = enabled
    this.orbit.enabled = enabled && this.mode === 'orbit'
  }

  // What an orbit goes around: the surface that is seen, if told, else what lies ahead.
  aim(distance?: number): void {
    const camera = this.stage.camera
    const size = this.stage.bounds.getSize(new THREE.Vector3()).length()
    const ahead = camera.getWorldDirection(new THREE.Vector3()).multiplyScalar(distance ?? 0.3 * size)
    const [position, turn] = [camera.position.clone(), camera.quaternion.clone()]
    this.orbit.enableDamping = false
    this.orbit.update() // whatever still swings
    this.orbit.enableDamping = true
    camera.position.copy(position)
    camera.quaternion.copy(turn)
    this.orbit.target.copy(position).add(ahead)
    this.orbit.update()
  }

  private speed(): number {
    return 0.12 * this.stage.bounds.getSize(new THREE.Vector3()).length()
  }

  private key(e: KeyboardEvent, down: boolean): void {
    if (!(e.code in kKeys) && !(e.code in kTurns)) return
    if (e.ctrlKey || e.metaKey || e.altKey) return
    if (down) {
      if (this.mode === 'orbit' && !e.code.startsWith('Arrow')) return
      this.down.add(e.code)
      e.preventDefault()
    } else this.down.delete(e.code)
  }

  private press(e: PointerEvent): void {
    this.stage.canvas.focus()
    if (this.mode !== 'walk' || !this.enabled) return
    this.stage.canvas.setPointerCapture(e.pointerId)
    this.pointers.set(e.pointerId, { x: e.clientX, y: e.clientY })
  }

  private drag(e: PointerEvent): void {
    const last = this.pointers.get(e.pointerId)
    if (!last || this.mode !== 'walk' || !this.enabled) return
    const [dx, dy] = [e.clientX - last.x, e.clientY - last.y]
    this.pointers.set(e.pointerId, { x: e.clientX, y: e.clientY })
    if (this.pointers.size === 1) {
      this.turn(dx * kTurnPerPixel, dy * kTurnPerPixel)
      return
    }
    // Two fingers: up and down goes ahead and back, sideways steps aside.
    const scale = (0.004 * this.speed()) / this.pointers.size
    this.go(-dx * scale, 0, -dy * scale)
    const [a, b] = [...this.pointers.values()]
    const spread = Math.hypot(a.x - b.x, a.y - b.y)
    if (this.pinch > 0) this.go(0, 0, (spread - this.pinch) * scale * 2)
    this.pinch = spread
  }

  private wheel(e: WheelEvent): void {
    if (this.mode !== 'walk' || !this.enabled) return
    e.preventDefault()
    this.go(0, 0, -0.002 * e.deltaY * this.speed())
  }

  private turn(yaw: number, pitch: number): void {
    const euler = new THREE.Euler().setFromQuaternion(this.stage.camera.quaternion, 'YXZ')
    euler.y += yaw
    euler.x = Math.min(1.5, Math.max(-1.5, euler.x + pitch))
    euler.z = 0
    this.stage.camera.quaternion.setFromEuler(euler)
    this.moved = true
  }

  private go(right: number, up: number, ahead: number): void {
    const camera = this.stage.camera
    const forward = camera.getWorldDirection(new THREE.Vector3())
    const side = new THREE.Vector3().crossVectors(forward, new THREE.Vector3(0, 1, 0)).normalize()
    camera.position.addScaledVector(forward, ahead).addScaledVector(side, right)
    camera.position.y += up
    this.moved = true
  }

  // Returns whether anything moved.
  private step(seconds: number): boolean {
    for (const code of this.down) {
      if (code in kTurns) this.turn(kTurns[code] * 1.2 * seconds, 0)
      else {
        const [right, up, ahead] = kKeys[code]
        const far = this.speed() * seconds
        this.go(right * far, up * far, ahead * far)
      }
    }
    if (this.mode === 'orbit') {
      if (this.down.size > 0) this.aim(this.orbit.getDistance())
      else if (this.orbit.enabled) this.orbit.update()
    }
    const moving = this.moved
    this.moved = false
    if (this.wasMoving && !moving && this.pointers.size === 0) this.onRest()
    this.wasMoving = moving
    return moving
  }
}
