// How much of the picture may be drawn for a wanted pace: resolution is given up first, then the
// smallest triangles of a mesh that is large.

const kWanted = 33 // milliseconds a frame
const kCoarsest = 0.4 // of the full resolution
const kFirstTriangles = 60_000
const kFewestTriangles = 20_000
const kSteps = 16 // resolutions: each change costs new buffers

export class Pace {
  private sharpness = 0.7 // resolution
  private triangles = kFirstTriangles
  private smoothed = kWanted

  // After a frame of a movement that took so long since the one before it. `left`: triangles were
  // left out of it.
  learn(milliseconds: number, mayLeaveOut: boolean): void {
    // One late frame says little.
    this.smoothed += 0.3 * (Math.min(milliseconds, 10 * kWanted) - this.smoothed)
    const ratio = kWanted / this.smoothed
    if (ratio < 0.9) {
      const slower = Math.max(0.8, Math.sqrt(ratio))
      if (this.sharpness > kCoarsest) this.sharpness = Math.max(kCoarsest, this.sharpness * slower)
      else if (mayLeaveOut) this.triangles = Math.max(kFewestTriangles, this.triangles * slower)
    } else if (ratio > 1.25) {
      if (mayLeaveOut && this.sharpness > 0.6) this.triangles *= 1.05
      else this.sharpness = Math.min(1, this.sharpness * 1.03)
    }
  }

  resolution(): number {
    return Math.ceil(this.sharpness * kSteps) / kSteps
  }
  mostTriangles(): number {
    return this.triangles
  }
  // Frames come too slowly, or would if the picture were whole.
  isStruggling(): boolean {
    return this.smoothed > 1.1 * kWanted || this.sharpness < 0.95
  }
}
