// How the solve goes: of each iteration the time, links and rays; and how many links err how much.
import uPlot from 'uplot'
import 'uplot/dist/uPlot.min.css'
import type { Connection, Status } from './connection'
import { short } from './probe'

interface Record_ {
  threshold: number
  links: number
  elements: number
  rays: number
  predicted: number
  seconds: number
}

const kHeight = 120
const compact = (v: number) => (v >= 1e6 ? `${short(v / 1e6)}M` : v >= 1e3 ? `${short(v / 1e3)}k` : v > 0 && v < 1e-3 ? v.toExponential(0) : short(v))

const colour = (name: string) => getComputedStyle(document.documentElement).getPropertyValue(name).trim()

export class Charts {
  private records: Record_[] = []
  private errors: { at: number; value: number }[] = []
  private plots: uPlot[] = []
  private session = ''
  private fetching = false

  constructor(
    private readonly section: HTMLElement,
    private readonly connection: Connection,
  ) {
    matchMedia('(prefers-color-scheme: dark)').addEventListener('change', () => this.rebuild())
    new ResizeObserver(() => this.resize()).observe(section)
  }

  get shown(): boolean {
    return !this.section.hidden
  }
  toggle(status: Status | null): void {
    this.section.hidden = !this.section.hidden
    if (this.shown) {
      this.rebuild()
      if (status) void this.follow(status)
    }
  }

  async follow(status: Status): Promise<void> {
    if (status.session !== this.session || status.records < this.records.length) {
      this.session = status.session
      this.records = []
      this.errors = []
    }
    if (status.error && this.errors[this.errors.length - 1]?.value !== status.error.estimated)
      this.errors.push({ at: Math.max(1, status.records), value: status.error.estimated })
    if (!this.shown || this.fetching) return
    this.fetching = true
    try {
      const first = this.records.length
      const answer = await this.connection.history(first)
      if (first === this.records.length) this.records.push(...answer.records)
      const histogram = await this.connection.layerText({ kind: 'histogram' })
      this.draw(histogram)
    } catch {
      // The next status tries again.
    }
    this.fetching = false
  }

  private axes(log: boolean): uPlot.Axis[] {
    const common = { stroke: colour('--text'), grid: { stroke: colour('--line'), width: 1 }, ticks: { stroke: colour('--line') } }
    // Powers of ten alone get lines and labels.
    const decades = (_: uPlot, splits: (number | null)[]) => splits.map((v) => (v && Number.isInteger(Math.round(1e9 * Math.log10(v)) / 1e9) ? v : null))
    const labels = (_: uPlot, splits: (number | null)[]) => splits.map((v) => (v === null ? '' : compact(v)))
    const y: uPlot.Axis = { ...common, size: 60, values: labels }
    return [{ ...common, size: 30 }, log ? { ...y, filter: decades, grid: { ...common.grid, filter: decades } as uPlot.Axis.Grid, ticks: { ...common.ticks, filter: decades } as uPlot.Axis.Ticks } : y]
  }

  private plot(title: string, series: uPlot.Series[], options: Partial<uPlot.Options> = {}): uPlot {
    const holder = document.createElement('figure')
    const caption = document.createElement('figcaption')
    caption.textContent = title
    holder.append(caption)
    this.section.append(holder)
    const made = new uPlot(
      {
        width: Math.max(200, holder.clientWidth),
        height: kHeight,
        scales: { x: { time: false }, y: { distr: 3, log: 10 } },
        axes: this.axes(options.scales === undefined),
        legend: { show: series.length > 1, live: false },
        cursor: { show: false },
        series: [{}, ...series],
        ...options,
      },
      [[], ...series.map(() => [])] as uPlot.AlignedData,
      holder,
    )
    this.plots.push(made)
    return made
  }

  private rebuild(): void {
    if (!this.shown) return
    for (const plot of this.plots) plot.destroy()
    this.plots = []
    this.section.replaceChildren()
    const line = (label: string, name: string): uPlot.Series => ({ label, stroke: colour(name), width: 1.5, points: { show: true, size: 3 } })
    this.plot('Seconds of each iteration', [line('taken', '--accent'), line('predicted', '--second')])
    this.plot('Links and rays', [line('links', '--accent'), line('rays', '--second')])
    this.plot('Threshold on link errors, W/m², and estimated error', [
      line('threshold', '--accent'),
      { ...line('estimated error', '--second'), points: { show: true, size: 7 } },
    ])
    this.plot(
      'Links by error relative to the threshold',
      [{ label: 'links', stroke: colour('--accent'), fill: colour('--accent-faint'), width: 1, paths: uPlot.paths.bars!({ size: [0.95] }) }],
      {
        scales: { x: { time: false }, y: { distr: 1 } },
        hooks: {
          // What lies right of 1 is refined in this level, right of 1/4 in the next.
          draw: [
            (u) => {
              const ctx = u.ctx
              for (const [x, label] of [[0, 'now'], [Math.log10(0.25), 'next']] as [number, string][]) {
                const at = u.valToPos(x, 'x', true)
                ctx.save()
                ctx.strokeStyle = ctx.fillStyle = colour('--second')
                ctx.setLineDash([4, 4])
                ctx.beginPath()
                ctx.moveTo(at, u.bbox.top)
                ctx.lineTo(at, u.bbox.top + u.bbox.height)
                ctx.stroke()
                ctx.font = `${11 * devicePixelRatio}px sans-serif`
                ctx.textAlign = label === 'now' ? 'left' : 'right'
                ctx.fillText(label, at + (label === 'now' ? 4 : -4), u.bbox.top + 12 * devicePixelRatio)
                ctx.restore()
              }
            },
          ],
        },
      },
    )
  }

  private draw(histogram: any): void {
    if (this.plots.length < 4) return
    const x = this.records.map((_, i) => i + 1)
    const of = (pick: (r: Record_) => number) => this.records.map((r) => (pick(r) > 0 ? pick(r) : null))
    const errors: (number | null)[] = x.map(() => null)
    for (const e of this.errors) if (e.at <= errors.length) errors[e.at - 1] = e.value
    this.plots[0].setData([x, of((r) => r.seconds), of((r) => r.predicted)])
    this.plots[1].setData([x, of((r) => r.links), of((r) => r.rays)])
    this.plots[2].setData([x, of((r) => r.threshold), errors])
    this.plots[3].setData([
      histogram.counts.map((_: number, i: number) => histogram.lowest + (i + 0.5) * histogram.step),
      histogram.counts,
    ])
  }

  private resize(): void {
    for (const plot of this.plots) {
      const width = Math.max(200, plot.root.parentElement?.clientWidth ?? 0)
      if (plot.width !== width) plot.setSize({ width, height: kHeight })
    }
  }
}
