// Which triangles are worth drawing: chunks of the mesh that lie out of sight or turn their backs are
// left out (src/halflight/view/view_chunks.h).
import * as THREE from 'three'

interface Chunk {
  draw: number
  first: number // triangles
  count: number
  box: THREE.Box3
  middle: THREE.Vector3
  radius: number
  depth: number // half of its size along the axis
  axis: THREE.Vector3 // of a cone that holds all normals
  sine: number // of its half angle
}

export interface Group {
  start: number // indices
  count: number
  materialIndex: number
}

const kWords = 13

export class Chunks {
  private readonly chunks: Chunk[] = []
  private readonly frustum = new THREE.Frustum()
  private readonly seen = new THREE.Matrix4()
  private readonly ray = new THREE.Vector3()

  constructor(words: Uint32Array) {
    const floats = new Float32Array(words.buffer, words.byteOffset, words.length)
    for (let i = 0; i < words.length; i += kWords) {
      const vector = (at: number) => new THREE.Vector3(floats[i + at], floats[i + at + 1], floats[i + at + 2])
      const box = new THREE.Box3(vector(3), vector(6))
      const size = box.getSize(new THREE.Vector3())
      const axis = vector(9)
      this.chunks.push({
        draw: words[i],
        first: words[i + 1],
        count: words[i + 2],
        box,
        middle: box.getCenter(new THREE.Vector3()),
        radius: 0.5 * size.length(),
        depth: 0.5 * (size.x * Math.abs(axis.x) + size.y * Math.abs(axis.y) + size.z * Math.abs(axis.z)),
        axis,
        sine: floats[i + 12],
      })
    }
  }

  private isSeen(chunk: Chunk, eye: THREE.Vector3): boolean {
    if (!this.frustum.intersectsBox(chunk.box)) return false
    // Backs everywhere: the eye lies behind all planes that touch the box and face into the cone.
    // The sphere around the box is the better bound for wide cones, its depth for narrow ones.
    const along = this.ray.copy(chunk.middle).sub(eye)
    const [behind, distance] = [along.dot(chunk.axis), along.length()]
    const isTurned = behind >= chunk.sine * distance + chunk.radius || behind >= chunk.sine * (distance + chunk.radius) + chunk.depth
    return !isTurned
  }

  // Of chunks in sight the first triangles, which are the largest: so many of all that are in sight.
  // Neighbours go together.
  visible(camera: THREE.PerspectiveCamera, most: number): { groups: Group[]; triangles: number; drawn: number } {
    camera.updateMatrixWorld()
    this.frustum.setFromProjectionMatrix(this.seen.multiplyMatrices(camera.projectionMatrix, camera.matrixWorldInverse))
    const chunks = this.chunks.filter((c) => this.isSeen(c, camera.position))
    const triangles = chunks.reduce((sum, c) => sum + c.count, 0)
    const share = Math.min(1, most / Math.max(1, triangles))
    const groups: Group[] = []
    let drawn = 0
    for (const c of chunks) {
      const count = share < 1 ? Math.ceil(share * c.count) : c.count
      const last = groups[groups.length - 1]
      drawn += count
      if (last && last.materialIndex === c.draw && last.start + last.count === 3 * c.first) last.count += 3 * count
      else groups.push({ start: 3 * c.first, count: 3 * count, materialIndex: c.draw })
    }
    return { groups, triangles, drawn }
  }
}
