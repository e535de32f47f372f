import './style.css'
import { Connection, RequestError, type Status } from './connection'
import { Charts } from './charts'
import { viridis } from './colours'
import { Layers, kLayers, type LayerLegend } from './layers'
import { Motion } from './motion'
import { Mover } from './mover'
import { makePanel, type Panel } from './panel'
import { kUnits, short, showProbe, type UnitName } from './probe'
import { Stage } from './stage'
import { setShow, setToneMap, shared, type Show, type ToneMap } from './surface'

const element = <T extends HTMLElement>(id: string) => document.getElementById(id) as T

const stage = new Stage(element<HTMLCanvasElement>('picture'))
const connection = new Connection()
const motion = new Motion(stage)
const layers = new Layers(stage, connection, element<HTMLCanvasElement>('mask'))
const charts = new Charts(element('charts'), connection)
const mover = new Mover(stage, motion, (node, offset) => act({ node, offset }))

// What the user has chosen of the picture; the rest is the server's.
export const picture = {
  ev: 0,
  toneMap: 'agx' as ToneMap,
  show: 'light' as Show,
  unit: 'W/m²' as UnitName,
  autoScale: true,
  scale: 1, // full scale of false colour, in the unit
}
let status: Status | null = null
let autoExposure = 1
let probed: any = null
let pinned = false
let lost = false
let panel: Panel

function say(title: string, remedy: string, kind: 'alarm' | 'notice' | 'none'): void {
  const message = element('message')
  message.hidden = kind === 'none'
  message.className = kind
  const strong = document.createElement('strong')
  strong.textContent = title
  message.replaceChildren(strong, remedy)
}

let toastTimer = 0
function toast(text: string): void {
  say(text, '', 'notice')
  clearTimeout(toastTimer)
  toastTimer = window.setTimeout(() => showSentence(), 4000)
}
const fail = (error: Error) => toast(error instanceof RequestError ? error.message : String(error.message ?? error))

function showSentence(): void {
  if (status?.sentence) say(status.sentence, status.remedy, status.phase === 'failed' ? 'alarm' : 'notice')
  else say('', '', 'none')
}

async function act(command: object): Promise<void> {
  try {
    await connection.control(command)
  } catch (error) {
    fail(error as Error)
  }
}

// Where a processor stands for a graphics card it is the solver's, too: while the user looks around
// it is asked to leave the processor to the picture.
const kAskMilliseconds = 200
let lastAsked = 0
stage.onStruggle = () => {
  const busy = status?.phase === 'solving' || status?.phase === 'sharpening'
  if (!busy || lost || performance.now() - lastAsked < kAskMilliseconds) return
  lastAsked = performance.now()
  connection.control({ giveWay: true }).catch(() => {})
}

// Light and meshes, pulled one after the other as the versions rise.
let pulling = false
async function pull(): Promise<void> {
  if (pulling || !status) return
  pulling = true
  try {
    while (status.version > 0 && (status.epoch !== stage.epoch || status.version > stage.version)) {
      if (status.epoch === stage.epoch) {
        const light = await connection.light(stage.epoch, stage.version)
        if (!light) break
        if (!stage.update(light)) continue
        autoExposure = light.header.exposure
      } else {
        const topology = await connection.topology()
        const light = topology && (await connection.light(topology.header.epoch, 0))
        if (!topology || !light || light.header.epoch !== topology.header.epoch) {
          await new Promise((resolve) => setTimeout(resolve, 20))
          continue
        }
        const first = stage.header === null
        stage.show(topology, light)
        autoExposure = light.header.exposure
        if (first) {
          stage.setView(topology.header.firstView)
          motion.aim()
        }
        panel.follow(topology.header, status)
        mover.follow(topology.header)
      }
      applyPicture()
      if (layers.layer === 'error' || layers.layer === 'elements') void layers.refresh()
    }
  } catch (error) {
    if (!lost) fail(error as Error)
  }
  pulling = false
}

function fullFigure(high: number): number {
  const step = 10 ** Math.floor(Math.log10(high || 1))
  return Math.ceil(high / step) * step
}

const kLeastErrorScale = 0.2
export function applyPicture(): void {
  shared.exposure.value = autoExposure * 2 ** picture.ev
  const isError = layers.layer === 'error'
  const otherMap = setToneMap(picture.toneMap)
  const otherShow = setShow(isError ? 'error' : picture.show)
  if (otherMap || otherShow) stage.recompile()
  const factor = kUnits[picture.unit]
  if (picture.autoScale) {
    picture.scale = fullFigure(factor * stage.highIlluminance())
  }
  shared.factor.value = factor
  // The bounds of the first links are far above what is aimed at.
  const errorScale = isError ? Math.max(kLeastErrorScale, fullFigure(stage.highValue())) : 0
  shared.scale.value = isError ? errorScale : picture.scale
  const legend: LayerLegend | null = isError
    ? { title: 'Error', low: 0, high: 100 * errorScale, unit: '%' }
    : picture.show === 'irradiance'
      ? { title: picture.unit === 'lux' ? 'Illuminance' : 'Irradiance', low: 0, high: picture.scale, unit: picture.unit }
      : layers.legend
  showLegend(legend)
  stage.draw()
}

function showLegend(legend: LayerLegend | null): void {
  element('legend').hidden = !legend
  if (!legend) return
  element('legend-title').textContent = `${legend.title}, ${legend.unit}`
  const canvas = element<HTMLCanvasElement>('legend-bar')
  const ctx = canvas.getContext('2d')!
  for (let y = 0; y < canvas.height; ++y) {
    const c = viridis(1 - (y + 0.5) / canvas.height).map((v) => Math.round(255 * v))
    ctx.fillStyle = `rgb(${c})`
    ctx.fillRect(0, y, canvas.width, 1)
  }
  const log = legend.low > 0
  const labels = [1, 0.75, 0.5, 0.25, 0].map((t) => {
    const value = log ? legend.low * (legend.high / legend.low) ** t : legend.low + t * (legend.high - legend.low)
    const li = document.createElement('li')
    li.textContent = short(value)
    return li
  })
  element('legend-labels').replaceChildren(...labels)
}

const kPhases: Record<Status['phase'], string> = {
  loading: 'Reading the scene',
  building: 'Building the hierarchy',
  solving: 'Solving',
  paused: 'Paused',
  limited: 'Limit reached',
  sharpening: 'Sharpening',
  done: 'Done',
  failed: 'Failed',
}

function share(s: Status): number | null {
  if (s.phase === 'done' || s.phase === 'limited') return 1
  if (s.phase !== 'solving' && s.phase !== 'paused') return null
  if (s.stage === 'sample' && s.receivers) return 0.3 + 0.65 * (1 - (s.receiversLeft ?? 0) / s.receivers)
  if (s.stage === 'converge' || s.stage === 'done') return 0.97
  return (0.3 * (s.level ?? 0)) / (s.levels || 1)
}

function showStatus(): void {
  const bar = element<HTMLProgressElement>('share')
  const text = element('status-text')
  if (lost) {
    bar.hidden = true
    text.textContent = 'Connection lost. Waiting for halflight view to come back.'
    return
  }
  if (!status) return
  // Nothing moves by itself: where a processor draws, an animation takes all of its time.
  const done = share(status)
  bar.hidden = done === null
  bar.value = done ?? 0
  const parts = [kPhases[status.phase]]
  if (status.phase === 'solving' && status.stage) parts[0] += `: ${status.stage}`
  if (status.elements) parts.push(`${status.elements.toLocaleString('en')} elements`)
  if (status.links) parts.push(`${status.links.toLocaleString('en')} links`)
  if (status.solvingSeconds) parts.push(`${status.solvingSeconds.toFixed(1)} s`)
  if (status.error) parts.push(`error ${(100 * status.error.estimated).toFixed(1)} %`)
  text.textContent = parts.join(' · ')
}

// Words and controls follow the status a few times a second: each change has the page drawn anew.
const kTextMilliseconds = 250
let textTimer = 0
let lastText = 0
function soon(): void {
  if (textTimer) return
  textTimer = window.setTimeout(() => {
    textTimer = 0
    lastText = performance.now()
    showSentence()
    showStatus()
    if (status) panel.update(status)
  }, Math.max(0, lastText + kTextMilliseconds - performance.now()))
}

let lastLayerRecords = 0
connection.onStatus = (next) => {
  const restarted = status && status.session !== next.session
  lost = false
  status = next
  if (restarted) stage.epoch = 0
  soon()
  void charts.follow(next)
  void pull()
  if (layers.layer === 'clusters' || layers.layer === 'none') return
  // What follows the solve is asked for now and then.
  if (next.records < lastLayerRecords) lastLayerRecords = 0
  if (next.records > lastLayerRecords + 8) {
    lastLayerRecords = next.records
    void layers.refresh()
  }
}
connection.onLost = () => {
  if (status?.phase === 'failed') return
  lost = true
  showStatus()
}

// The probe follows the pointer, a click pins it and picks the element and the object.
let asking = false
let wanted: { x: number; y: number; exact: boolean } | null = null
async function probeAt(x: number, y: number, exact: boolean): Promise<void> {
  wanted = { x, y, exact }
  if (asking) return
  asking = true
  while (wanted) {
    const at: { x: number; y: number; exact: boolean } = wanted
    wanted = null
    const ray = stage.ray(at.x, at.y)
    try {
      const answer = await connection.probe(ray.origin, ray.direction, at.exact)
      if (answer.busy) {
        if (at.exact) toast('The solver is busy. Click again in a moment.')
        continue
      }
      probed = answer
      pinned = at.exact
      showProbe(element('probe'), probed, picture.unit, pinned)
      if (at.exact && probed.hit) {
        layers.element = probed.element?.id ?? null
        mover.select(probed.node)
        panel.select(probed.node)
        if (layers.layer === 'links' || layers.layer === 'cut') void layers.refresh()
      }
    } catch {
      // The solver may be busy; the next movement asks again.
    }
  }
  asking = false
}

const canvas = stage.canvas
let pressed: { x: number; y: number } | null = null
canvas.addEventListener('pointerdown', (e) => (pressed = { x: e.clientX, y: e.clientY }))
canvas.addEventListener('pointermove', (e) => {
  if (e.buttons === 0 && e.pointerType === 'mouse' && !pinned && stage.header) void probeAt(e.offsetX, e.offsetY, false)
})
canvas.addEventListener('pointerup', (e) => {
  const still = pressed && Math.hypot(e.clientX - pressed.x, e.clientY - pressed.y) < 5
  pressed = null
  if (still && !mover.dragging && stage.header) void probeAt(e.offsetX, e.offsetY, true)
})
canvas.addEventListener('pointerleave', () => {
  if (!pinned) element('probe').hidden = true
})
function unpin(): void {
  pinned = false
  element('probe').hidden = true
  mover.select(null)
  panel.select(null)
}

function save(blob: Blob, name: string): void {
  const link = document.createElement('a')
  link.href = URL.createObjectURL(blob)
  link.download = name
  link.click()
  setTimeout(() => URL.revokeObjectURL(link.href), 10_000)
}

export const actions = {
  pause: () => act({ paused: !status?.paused }),
  step: () => act({ paused: true, step: true }),
  refineHere: () => act({ important: stage.view() }),
  refineAll: () => act({ allImportant: true }),
  screenshot: async () => save(await stage.screenshot(), 'halflight.png'),
  async litScene(): Promise<void> {
    toast('The lit scene is being written.')
    try {
      save(await connection.download('api/lit.glb', {}), 'lit.glb')
    } catch (error) {
      fail(error as Error)
    }
  },
  async hdrPicture(): Promise<void> {
    toast('The picture is being computed.')
    try {
      save(await connection.download('api/view.exr', stage.view()), 'view.exr')
    } catch (error) {
      fail(error as Error)
    }
  },
  charts: () => charts.toggle(status),
  camera(view: any): void {
    stage.setView(view)
    motion.aim()
  },
  mode(mode: 'orbit' | 'walk'): void {
    motion.setMode(mode)
    stage.canvas.focus()
  },
  layer(): void {
    if (layers.layer !== 'links' && layers.layer !== 'cut') layers.legend = null
    void layers.refresh().then(applyPicture)
    applyPicture()
  },
  unit: () => (showProbe(element('probe'), probed, picture.unit, pinned), applyPicture()),
  help(): void {
    const help = element('help')
    help.hidden = !help.hidden
  },
  act,
}
layers.onText = (text) => panel.layerText(text)
layers.onFail = fail
layers.onValues = applyPicture

panel = makePanel(element('panel'), { picture, layers, mover, motion, actions, applyPicture })

const kHelp: [string, string][] = [
  ['drag', 'turn; walk: look around'],
  ['W A S D, Q E', 'walk, down and up'],
  ['arrows', 'walk ahead and back, turn'],
  ['click', 'probe, pick an element and an object'],
  ['Esc', 'let go of the probe'],
  ['V', 'orbit or walk'],
  ['1 … 9', 'cameras of the scene'],
  ['0', 'first view'],
  ['[ and ]', 'darker and brighter'],
  ['T', 'next tone map'],
  ['F', 'light or false colour'],
  ['U', 'W/m² or lux'],
  ['L', 'next layer'],
  ['C', 'charts'],
  ['Space', 'pause and go on'],
  ['.', 'one step'],
  ['R', 'refine what is seen'],
  ['H', 'hide the controls'],
  ['?', 'this list'],
]
{
  const title = document.createElement('h2')
  title.textContent = 'Keys'
  const list = document.createElement('dl')
  for (const [key, what] of kHelp) {
    const dt = document.createElement('dt')
    const kbd = document.createElement('kbd')
    kbd.textContent = key
    dt.append(kbd)
    const dd = document.createElement('dd')
    dd.textContent = what
    list.append(dt, dd)
  }
  const close = document.createElement('button')
  close.textContent = 'Close'
  close.onclick = () => actions.help()
  element('help').replaceChildren(title, list, close)
}

function next<T>(all: readonly T[], now: T): T {
  return all[(all.indexOf(now) + 1) % all.length]
}

window.addEventListener('keydown', (e) => {
  const target = e.target as HTMLElement
  if (e.ctrlKey || e.metaKey || e.altKey || /^(INPUT|SELECT|TEXTAREA)$/.test(target.tagName)) return
  const onButton = target.tagName === 'BUTTON'
  const keys: Record<string, () => void> = {
    ' ': () => void actions.pause(),
    '.': () => void actions.step(),
    r: () => void actions.refineHere(),
    v: () => panel.setMode(next(['orbit', 'walk'] as const, motion.mode)),
    t: () => ((picture.toneMap = next(['agx', 'neutral', 'none'] as const, picture.toneMap)), panel.refresh(), applyPicture()),
    f: () => ((picture.show = picture.show === 'light' ? 'irradiance' : 'light'), panel.refresh(), applyPicture()),
    u: () => ((picture.unit = picture.unit === 'lux' ? 'W/m²' : 'lux'), panel.refresh(), actions.unit()),
    l: () => ((layers.layer = next(Object.values(kLayers), layers.layer)), panel.refresh(), actions.layer()),
    c: () => actions.charts(),
    h: () => panel.toggle(),
    '?': () => actions.help(),
    '[': () => ((picture.ev -= 0.25), panel.refresh(), applyPicture()),
    ']': () => ((picture.ev += 0.25), panel.refresh(), applyPicture()),
    '0': () => stage.header && actions.camera(stage.header.firstView),
    Escape: () => (element('help').hidden ? unpin() : actions.help()),
  }
  if (e.key >= '1' && e.key <= '9') {
    const camera = stage.header?.cameras[Number(e.key) - 1]
    if (camera) actions.camera(camera)
    return
  }
  if (onButton && (e.key === ' ' || e.key === 'Enter')) return
  const run = keys[e.key]
  if (!run) return
  e.preventDefault()
  run()
})

// For tests and for who looks under the bonnet.
Object.assign(window, {
  halflight: { stage, layers, picture, motion, mover, connection, actions, status: () => status, probe: () => probed },
})

connection.open()
