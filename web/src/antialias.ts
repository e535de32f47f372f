// Smooth edges for a picture that stands: the mean of frames that are a part of a pixel apart. Each
// is drawn when there is time, and a movement ends it; many samples a pixel at once would take a
// processor that stands for a graphics card seconds.
import * as THREE from 'three'

// Of the first frame and those to come, in pixels from its middle.
const kShifts = [[0, 0], [0.25, -0.375], [-0.25, 0.375], [0.375, 0.25], [-0.375, -0.25]]

export class Antialias {
  private readonly target = new THREE.WebGLRenderTarget(1, 1, { minFilter: THREE.NearestFilter, magFilter: THREE.NearestFilter })
  private readonly material = new THREE.ShaderMaterial({
    glslVersion: THREE.GLSL3,
    vertexShader: 'void main() { gl_Position = vec4(position, 1.); }',
    fragmentShader: `
uniform sampler2D frame;
uniform float weight;
layout(location = 0) out vec4 shown;
void main() { shown = vec4(texelFetch(frame, ivec2(gl_FragCoord.xy), 0).rgb, weight); }`,
    uniforms: { frame: { value: this.target.texture }, weight: { value: 1 } },
    transparent: true,
    depthTest: false,
    depthWrite: false,
  })
  private readonly scene = new THREE.Scene()
  private readonly camera = new THREE.OrthographicCamera(-1, 1, 1, -1, 0, 1)
  private done = 0

  constructor(private readonly renderer: THREE.WebGLRenderer) {
    const quad = new THREE.Mesh(new THREE.PlaneGeometry(2, 2), this.material)
    quad.frustumCulled = false
    this.scene.add(quad)
  }

  // After the picture was drawn anew, as the first of the frames.
  restart(): void {
    this.done = 1
  }
  isDone(): boolean {
    return this.done >= kShifts.length
  }

  // One more frame into what the canvas holds.
  add(camera: THREE.PerspectiveCamera, draw: () => void): void {
    const size = this.renderer.getDrawingBufferSize(new THREE.Vector2())
    this.target.setSize(size.x, size.y)
    const [x, y] = kShifts[this.done++]
    camera.setViewOffset(size.x, size.y, x, y, size.x, size.y)
    this.renderer.setRenderTarget(this.target)
    draw()
    this.renderer.setRenderTarget(null)
    camera.clearViewOffset()
    this.material.uniforms.weight.value = 1 / this.done
    this.renderer.autoClear = false
    this.renderer.render(this.scene, this.camera)
    this.renderer.autoClear = true
  }
}
