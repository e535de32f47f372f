// The controls at the side.
import GUI, { type Controller } from 'lil-gui'
import type { Status } from './connection'
import { kLayers, type Layers } from './layers'
import type { Mode, Motion } from './motion'
import type { Mover } from './mover'
import { fromHex, toHex } from './colours'
import { kUnits } from './probe'

export interface Panel {
  follow(header: any, status: Status): void // of another mesh
  update(status: Status): void
  refresh(): void
  select(node: number | null): void
  setMode(mode: Mode): void
  layerText(text: string): void
  toggle(): void
}

interface Parts {
  picture: any
  layers: Layers
  mover: Mover
  motion: Motion
  actions: any
  applyPicture: () => void
}

const kSmallScreen = 720

export function makePanel(container: HTMLElement, parts: Parts): Panel {
  const { picture, layers, mover, motion, actions, applyPicture } = parts
  const gui = new GUI({ container, title: 'Halflight' })
  const small = () => window.innerWidth <= kSmallScreen
  if (small()) gui.close()

  const look = gui.addFolder('Look')
  const choice = { mode: 'orbit' as Mode, camera: 'first view' }
  const mode = look.add(choice, 'mode', ['orbit', 'walk']).name('move by').onChange((m: Mode) => actions.mode(m))
  let cameras = new Map<string, any>()
  let camera = look.add(choice, 'camera', ['first view']).name('camera')
  const onCamera = (name: string) => cameras.has(name) && actions.camera(cameras.get(name))
  look.add(picture, 'show', { light: 'light', 'false colour': 'irradiance', 'shape only': 'shape' }).name('show').onChange(applyPicture)
  look.add(picture, 'ev', -8, 8, 0.05).name('exposure, EV').onChange(applyPicture)
  look.add(picture, 'toneMap', ['agx', 'neutral', 'none']).name('tone map').onChange(applyPicture)
  look.add(picture, 'unit', Object.keys(kUnits)).name('unit').onChange(() => actions.unit())
  look.add(picture, 'autoScale').name('scale by itself').onChange(applyPicture)
  look.add(picture, 'scale', 0.001).name('full scale').decimals(3).onChange(() => ((picture.autoScale = false), gui.controllersRecursive().forEach((c) => c.updateDisplay()), applyPicture()))

  const solve = gui.addFolder('Solve')
  const wishes = { featureSize: 5, error: 5, visibility: 'multires', seconds: 0, links: 0, paused: false }
  const pause = solve.add(actions, 'pause').name('pause')
  solve.add(actions, 'step').name('one step')
  solve.add(actions, 'refineHere').name('refine here')
  const everywhere = solve.add(actions, 'refineAll').name('refine everywhere alike')
  solve.add(wishes, 'featureSize', 0.1, 500, 0.1).name('feature size, cm').onFinishChange((v: number) => actions.act({ featureSize: v / 100 }))
  solve.add(wishes, 'error', 0.5, 50, 0.5).name('error, %').onFinishChange((v: number) => actions.act({ error: v / 100 }))
  solve.add(wishes, 'visibility', ['exact', 'multires', 'average']).name('visibility').onChange((v: string) => actions.act({ visibility: v }))
  solve.add(wishes, 'seconds', 0, undefined, 0.5).name('time limit, s (0: none)').onFinishChange((v: number) => actions.act({ seconds: Math.max(0, v) }))
  solve.add(wishes, 'links', 0, undefined, 1).name('link limit (0: none)').onFinishChange((v: number) => actions.act({ links: Math.max(0, Math.round(v)) }))

  const lights = gui.addFolder('Lights')
  // Of each group: how bright its brightest channel is, and its colour then.
  const factors: Record<string, number> = Object.create(null) // by names that are any words
  const tints = new Map<string, HTMLInputElement>()
  let lightNames = ''
  const factor = (name: string) => {
    const tint = fromHex(tints.get(name)?.value ?? '#ffffff')
    const most = Math.max(...tint)
    return tint.map((c) => factors[name] * (most > 0 ? c / most : 1))
  }
  const addLight = (name: string) => {
    const dimmer = lights.add(factors, name, 0, 2, 0.01).onChange(() => void dim())
    const tint = document.createElement('input')
    tint.type = 'color'
    tint.value = '#ffffff'
    tint.title = 'Colour that the lamp is multiplied by; how bright it is, the dimmer says'
    tint.setAttribute('aria-label', `colour of ${name}`)
    tint.oninput = () => void dim()
    dimmer.domElement.querySelector('.lil-widget')!.append(tint)
    tints.set(name, tint)
  }
  const showLight = (group: NonNullable<Status['groups']>[number]) => {
    const controller = lights.controllers.find((c) => c.property === group.name)
    const tint = tints.get(group.name)
    const value = Math.max(...group.factor)
    if (!controller || !tint || isEdited(controller)) return
    if (Math.abs(factors[group.name] - value) > 1e-4) {
      factors[group.name] = value
      controller.updateDisplay()
    }
    if (value > 0) tint.value = toHex(group.factor.map((c) => c / value))
  }
  // The last factors always arrive, one request at a time.
  let dimming = false
  let undimmed = false
  const dim = async () => {
    undimmed = true
    if (dimming) return
    dimming = true
    while (undimmed) {
      undimmed = false
      await actions.act({ groups: Object.fromEntries(Object.keys(factors).map((name) => [name, factor(name)])) })
      await new Promise((resolve) => setTimeout(resolve, 30))
    }
    dimming = false
  }

  const object = gui.addFolder('Object')
  const chosen = { name: mover.name(null), shown: true, reset: () => mover.place([0, 0, 0]) }
  object.add(chosen, 'name').disable().name('picked')
  const place = () => mover.place([mover.offset.x, mover.offset.y, mover.offset.z])
  const axes = (['x', 'y', 'z'] as const).map((axis) => object.add(mover.offset, axis, -10, 10, 0.01).name(`move ${axis}, m`).onChange(place))
  object.add(chosen, 'shown').name('in the scene').onChange((v: boolean) => mover.node !== null && actions.act({ node: mover.node, shown: v }))
  object.add(chosen, 'reset').name('put back')
  mover.onMoved = () => axes.forEach((a) => a.updateDisplay())
  const hidden = new Map<number, boolean>()
  let edits: Status['edits'] = []
  const objects = () => {
    chosen.name = mover.name(mover.node)
    chosen.shown = mover.node === null || !hidden.get(mover.node)
    object.controllers.forEach((c) => (c.updateDisplay(), c.property !== 'name' && c.enable(mover.node !== null)))
  }
  object.close()
  objects()

  const understand = gui.addFolder('Understand')
  understand.add(layers, 'layer', kLayers).name('layer').onChange(() => (visible(), actions.layer()))
  const depth = understand.add(layers, 'depth', 0, 24, 1).name('depth').onChange(() => actions.layer())
  const colour = understand.add(layers, 'clusterColour', { BSIZE: 'blockerSize', extinction: 'extinction', 'exact or averaged': 'averaged' }).name('colour by').onChange(() => actions.layer())
  const pixels = understand.add(layers, 'pixels', 1, 100, 1).name('feature, pixels').onFinishChange(() => actions.layer())
  const note = document.createElement('p')
  note.style.cssText = 'margin:4px 8px 6px;font-size:12px'
  note.setAttribute('role', 'note')
  understand.$children.append(note)
  understand.add(actions, 'charts').name('charts')
  const visible = () => {
    depth.show(layers.layer === 'clusters')
    colour.show(layers.layer === 'clusters')
    pixels.show(layers.layer === 'features')
    note.textContent = ''
  }
  visible()
  understand.close()

  const files = gui.addFolder('Take home')
  files.add(actions, 'screenshot').name('screenshot (PNG)')
  files.add(actions, 'litScene').name('lit scene (glTF)')
  files.add(actions, 'hdrPicture').name('picture (OpenEXR)')
  files.add(actions, 'help').name('keys')
  files.close()

  const isEdited = (c: Controller) => c.domElement.contains(document.activeElement)
  const refresh = () => gui.controllersRecursive().forEach((c) => isEdited(c) || c.updateDisplay())

  return {
    follow(header) {
      cameras = new Map<string, any>([['first view', header.firstView]])
      header.cameras.forEach((c: any, i: number) => {
        const name = c.name || `camera ${i + 1}`
        let label = name
        for (let k = 2; cameras.has(label); ++k) label = `${name} ${k}`
        cameras.set(label, c)
      })
      camera = camera.options([...cameras.keys()]).name('camera').onChange(onCamera)
      objects()
    },
    update(status) {
      if (status.featureSize !== undefined) {
        const wish = (name: keyof typeof wishes, value: number | string) => {
          const controller = solve.controllers.find((c) => c.property === name)
          if (!controller || isEdited(controller) || wishes[name] === value) return
          ;(wishes as any)[name] = value
          controller.updateDisplay()
        }
        wish('featureSize', Number((100 * status.featureSize).toPrecision(4)))
        wish('error', Number((100 * (status.errorWanted ?? 0.05)).toPrecision(3)))
        wish('visibility', status.visibilityWanted ?? 'multires')
        wish('seconds', status.secondsLimit ?? 0)
        wish('links', status.linksLimit ?? 0)
      }
      pause.name(status.paused ? 'go on' : 'pause')
      everywhere.enable(Boolean(status.important))
      const names = (status.groups ?? []).map((g) => g.name).join('\n')
      if (names !== lightNames) {
        lightNames = names
        lights.children.slice().forEach((c) => c.destroy())
        tints.clear()
        for (const name of Object.keys(factors)) delete factors[name]
        for (const g of status.groups ?? []) {
          factors[g.name] = Math.max(...g.factor)
          addLight(g.name)
        }
      }
      if (!dimming) status.groups?.forEach(showLight)
      lights.show((status.groups ?? []).length > 0)
      if (JSON.stringify(edits) !== JSON.stringify(status.edits ?? [])) {
        edits = status.edits ?? []
        hidden.clear()
        for (const e of edits) hidden.set(e.node, !e.shown)
        objects()
      }
    },
    refresh,
    select: () => {
      objects()
      if (mover.node !== null && !small()) object.open()
    },
    setMode(m) {
      choice.mode = m
      mode.updateDisplay()
      motion.setMode(m)
      actions.mode(m)
    },
    layerText: (text) => (note.textContent = text),
    toggle: () => (container.hidden = !container.hidden),
  }
}
