// Moving and switching an object of the scene: a frame around it and handles to drag.
import * as THREE from 'three'
import { TransformControls } from 'three/addons/controls/TransformControls.js'
import type { Motion } from './motion'
import type { Stage } from './stage'

export class Mover {
  node: number | null = null
  readonly offset = { x: 0, y: 0, z: 0 }
  dragging = false
  onMoved: () => void = () => {}
  private readonly handle = new THREE.Object3D()
  private readonly controls: TransformControls
  private readonly frame = new THREE.Box3Helper(new THREE.Box3(), new THREE.Color(0xffc24d))
  private readonly offsets = new Map<number, [number, number, number]>()
  private grip: THREE.Vector3 | null = null
  private sending = false
  private unsent = false
  private nodes: any[] = []

  constructor(
    private readonly stage: Stage,
    motion: Motion,
    private readonly send: (node: number, offset: number[]) => Promise<void>,
  ) {
    this.controls = new TransformControls(stage.camera, stage.canvas)
    this.controls.setSize(0.7)
    stage.scene.add(this.handle)
    stage.scene.add(this.frame)
    this.frame.visible = false
    this.controls.addEventListener('dragging-changed', (e) => {
      this.dragging = Boolean(e.value)
      motion.setEnabled(!this.dragging)
      if (this.dragging) this.grip = this.handle.position.clone().sub(this.vector())
    })
    this.controls.addEventListener('objectChange', () => {
      if (!this.grip) return
      const at = this.handle.position.clone().sub(this.grip)
      this.place(at.toArray() as [number, number, number])
    })
    this.controls.addEventListener('change', () => stage.draw())
  }

  follow(header: any): void {
    this.nodes = header.nodes
    if (this.node !== null && !this.dragging) this.select(this.node)
  }

  select(node: number | null): void {
    this.node = node
    const box = node === null ? null : this.box(node)
    this.frame.visible = box !== null
    if (node !== null) [this.offset.x, this.offset.y, this.offset.z] = this.offsets.get(node) ?? [0, 0, 0]
    if (box) {
      this.frame.box.copy(box)
      box.getCenter(this.handle.position)
      this.controls.attach(this.handle)
      this.stage.scene.add(this.controls.getHelper())
    } else {
      this.controls.detach()
      this.stage.scene.remove(this.controls.getHelper())
    }
    this.stage.draw()
  }

  // Metres from where the file has it.
  place(offset: [number, number, number]): void {
    if (this.node === null) return
    const before = this.vector()
    offset = offset.map((v) => Math.round(1e4 * v) / 1e4) as [number, number, number]
    ;[this.offset.x, this.offset.y, this.offset.z] = offset
    this.offsets.set(this.node, offset)
    this.frame.box.translate(this.vector().sub(before))
    if (!this.dragging) this.frame.box.getCenter(this.handle.position)
    this.stage.draw()
    this.onMoved()
    void this.flush()
  }

  name(node: number | null): string {
    if (node === null) return 'none: click one'
    return this.nodes.find((n) => n.id === node)?.name || `node ${node}`
  }

  private vector(): THREE.Vector3 {
    return new THREE.Vector3(this.offset.x, this.offset.y, this.offset.z)
  }

  private box(node: number): THREE.Box3 | null {
    const box = this.nodes.find((n) => n.id === node)?.box
    return box ? new THREE.Box3(new THREE.Vector3(...box[0]), new THREE.Vector3(...box[1])) : null
  }

  // One move at a time; the last one always arrives.
  private async flush(): Promise<void> {
    this.unsent = true
    if (this.sending) return
    this.sending = true
    while (this.unsent && this.node !== null) {
      this.unsent = false
      const version = this.stage.version
      await this.send(this.node, [this.offset.x, this.offset.y, this.offset.z])
      for (let i = 0; i < 40 && this.stage.version === version; ++i) await new Promise((resolve) => setTimeout(resolve, 25))
    }
    this.sending = false
  }
}
