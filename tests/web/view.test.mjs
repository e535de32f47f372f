// The live view in a real browser: what is seen agrees with what the solver says, and every control
// does what it says.
import assert from 'node:assert/strict'
import { readFileSync, writeFileSync } from 'node:fs'
import { join } from 'node:path'
import { after, before, test } from 'node:test'
import {
  canvas, choose, control, difference, drawn, folder, launch, lit, linear, meanLight, open, picture, press, run, scene,
  serve, setNumber, settled, status, unfold, until,
} from './browser.mjs'

// One server and page for what changes nothing for good.
let browser, server, page, box
before(async () => {
  browser = await launch()
  box = scene('cornell-box')
  server = await serve(box, '--feature-size', '2cm')
  page = await open(browser, server.url)
  await lit(page)
})
after(async () => {
  await browser?.close()
  await server?.stop()
})

const values = (view) => page.evaluate(view)
const toolkit = () => page.evaluate(() => window.halflight.actions.camera(window.halflight.stage.header.firstView))

test('it lights up, sharpens and ends without a complaint', async () => {
  const first = await canvas(page)
  assert.ok(meanLight(first) > 0.02, 'the first picture is not black')
  await settled(page)
  const s = await status(page)
  assert.equal(s.sharp, true)
  assert.ok(s.error.estimated < 0.1)
  const last = await picture(page, 'light')
  assert.ok(meanLight(last) > 0.02)
  assert.deepEqual(page.complaints, [])
})

test('probes agree with halflight solve', async () => {
  await settled(page)
  const size = await values(() => [window.halflight.stage.canvas.clientWidth, window.halflight.stage.canvas.clientHeight])
  const points = []
  for (const [u, v] of [[0.5, 0.85], [0.25, 0.3], [0.7, 0.2], [0.5, 0.45]]) {
    await page.mouse.click(u * size[0], v * size[1])
    await until(page, 'a pinned probe', () => window.halflight.probe()?.hit && window.halflight.probe().direct)
    await page.waitForTimeout(300)
    points.push(await values(() => window.halflight.probe()))
  }
  await page.keyboard.press('Escape')
  const sensors = join(folder, 'sensors.txt')
  writeFileSync(sensors, points.map((p) => [...p.position, ...p.normal].join(' ')).join('\n') + '\n')
  const out = join(folder, 'sensors-out.txt')
  run('solve', box, '--feature-size', '2cm', '--points', sensors, '--points-out', out, '--progress', 'none')
  const rows = readFileSync(out, 'utf8').trim().split('\n').filter((l) => !l.startsWith('#')).map((l) => l.trim().split(/\s+/).map(Number))
  points.forEach((p, i) => {
    const expected = rows[i].slice(6, 9)
    for (let k = 0; k < 3; ++k)
      assert.ok(Math.abs(p.irradiance[k] - expected[k]) < 0.06 * Math.max(...expected), `${p.irradiance} against ${expected}`)
  })
})

test('pixels show exposure times radiance', async () => {
  await settled(page)
  await choose(page, 'tone map', 'none')
  const ev = -2
  await setNumber(page, 'exposure, EV', ev)
  const png = await canvas(page)
  const checked = await page.evaluate(async ([w, h]) => {
    const { stage, connection } = window.halflight
    const result = []
    for (const [u, v] of [[0.5, 0.9], [0.2, 0.5], [0.8, 0.5], [0.5, 0.3]]) {
      const ray = stage.ray(u * stage.canvas.clientWidth, v * stage.canvas.clientHeight)
      result.push({ x: Math.floor(u * w), y: Math.floor(v * h), p: await connection.probe(ray.origin, ray.direction, true) })
    }
    return result
  }, [png.width, png.height])
  const exposure = await page.evaluate(async () => {
    const packet = await window.halflight.connection.light(0, 0)
    return packet.header.exposure
  })
  for (const { x, y, p } of checked) {
    if (!p.hit || Math.max(...(p.emission ?? [0])) > 0) continue
    const i = 4 * (y * png.width + x)
    for (let k = 0; k < 3; ++k) {
      const expected = exposure * 2 ** ev * p.reflectance[k] * p.irradiance[k] / Math.PI
      assert.ok(Math.abs(linear(png.data[i + k]) - expected) < 0.1 * expected + 0.008, `pixel ${x}, ${y}: ${linear(png.data[i + k])}, not ${expected}`)
    }
  }
  await setNumber(page, 'exposure, EV', 0)
  await choose(page, 'tone map', 'agx')
})

test('exposure, tone maps, false colour and unit change the picture as they should', async () => {
  await settled(page)
  const agx = await canvas(page)
  await setNumber(page, 'exposure, EV', -1)
  assert.ok(meanLight(await canvas(page)) < 0.8 * meanLight(agx))
  await setNumber(page, 'exposure, EV', 0)
  const maps = { agx }
  for (const map of ['neutral', 'none']) {
    await choose(page, 'tone map', map)
    maps[map] = await picture(page, `tone-map-${map}`).then(() => canvas(page))
  }
  assert.ok(difference(maps.agx, maps.neutral) > 0.2)
  assert.ok(difference(maps.neutral, maps.none) > 0.001)
  await choose(page, 'tone map', 'agx')

  await choose(page, 'show', 'false colour')
  const watts = await picture(page, 'false-colour')
  const high = Number(await page.locator('#legend-labels li').first().textContent())
  assert.match(await page.locator('#legend-title').textContent(), /Irradiance, W\/m²/)
  await choose(page, 'unit', 'lux')
  await drawn(page)
  assert.match(await page.locator('#legend-title').textContent(), /Illuminance, lux/)
  const lux = Number(await page.locator('#legend-labels li').first().textContent())
  // 179 lm/W, and both scales are rounded to a full figure
  assert.ok(lux / high > 85 && lux / high < 360, `${lux} lux for ${high} W/m²`)
  await setNumber(page, 'full scale', lux * 4)
  assert.ok(meanLight(await canvas(page)) < meanLight(watts), 'a larger scale is darker')
  await choose(page, 'unit', 'W/m²')
  await choose(page, 'show', 'shape only')
  assert.ok(meanLight(await picture(page, 'shape')) > 0.02)
  await choose(page, 'show', 'light')
  await control(page, 'scale by itself').locator('input').check()
  assert.deepEqual(page.complaints, [])
})

test('orbit, walk and cameras move the eye', async () => {
  const eye = () => values(() => window.halflight.stage.camera.position.toArray())
  const moved = (a, b) => Math.hypot(...a.map((v, i) => v - b[i]))
  const start = await eye()
  await page.mouse.move(400, 350)
  await page.mouse.down()
  await page.mouse.move(500, 330, { steps: 5 })
  await page.mouse.up()
  await page.waitForTimeout(600)
  assert.ok(moved(start, await eye()) > 0.01, 'orbit goes around')
  await toolkit()
  await page.locator('#picture').focus()
  await page.keyboard.press('v')
  assert.equal(await values(() => window.halflight.motion.mode), 'walk')
  await page.keyboard.down('w')
  await page.waitForTimeout(500)
  await page.keyboard.up('w')
  const walked = await eye()
  assert.ok(moved(start, walked) > 0.02, 'W walks ahead')
  await page.mouse.move(400, 350)
  const before = await values(() => window.halflight.stage.view().forward)
  await page.mouse.down()
  await page.mouse.move(480, 350, { steps: 4 })
  await page.mouse.up()
  const turned = await values(() => window.halflight.stage.view().forward)
  assert.ok(moved(before, turned) > 0.1, 'a drag looks around')
  assert.ok(moved(walked, await eye()) < 1e-6, 'and stays in place')
  await page.keyboard.press('v')
  await page.keyboard.press('1')
  const camera = await values(() => window.halflight.stage.header.cameras[0].position)
  assert.ok(moved(camera, await eye()) < 1e-3, '1 is the first camera of the scene')
  await toolkit()
})

test('each layer draws something of its own', async () => {
  await settled(page)
  await page.keyboard.press('Escape')
  await page.mouse.click(380, 600)
  await until(page, 'an element', () => window.halflight.layers.element !== null)
  await unfold(page, 'Understand')
  await choose(page, 'layer', 'none')
  const plain = await canvas(page)
  for (const [label, share] of [
    ['element mesh', 0.01],
    ['clusters by depth', 0.0005],
    ['links of the probed element', 0.0005],
    ['estimated error', 0.3],
  ]) {
    await choose(page, 'layer', label)
    await page.waitForTimeout(500)
    await picture(page, `layer-${label.replace(/ /g, '-')}`)
    const changed = difference(plain, await canvas(page))
    assert.ok(changed > share, `${label}: ${changed} of the pixels`)
  }
  await choose(page, 'layer', 'exact and averaged')
  await until(page, 'a sentence', () => /traced exactly|Ray to the brightest/.test(document.body.textContent))
  await choose(page, 'layer', 'feature mask')
  await until(page, 'the mask', () => !document.getElementById('mask').hidden, 30)
  await picture(page, 'layer-features')
  const classes = await values(() => {
    const mask = document.getElementById('mask')
    const data = mask.getContext('2d').getImageData(0, 0, mask.width, mask.height).data
    let [features, clear] = [0, 0]
    for (let i = 3; i < data.length; i += 4) data[i] > 140 ? ++features : data[i] === 0 && ++clear
    return { features, clear }
  })
  assert.ok(classes.features > 100 && classes.clear > 100, JSON.stringify(classes))
  await choose(page, 'layer', 'none')
  await page.keyboard.press('Escape')
  assert.deepEqual(page.complaints.filter((c) => !/400/.test(c)), [])
  page.complaints.length = 0
})

test('charts follow the solve', async () => {
  await page.locator('#picture').focus()
  await page.keyboard.press('c')
  await until(page, 'four charts', () => document.querySelectorAll('#charts canvas').length === 4)
  await page.waitForTimeout(500)
  await picture(page, 'charts')
  const inked = await values(() =>
    [...document.querySelectorAll('#charts canvas')].map((c) => {
      const data = c.getContext('2d').getImageData(0, 0, c.width, c.height).data
      let ink = 0
      for (let i = 3; i < data.length; i += 4) ink += data[i] > 0 ? 1 : 0
      return ink
    }),
  )
  for (const ink of inked) assert.ok(ink > 300, `${inked}`)
  await page.keyboard.press('c')
})

test('pictures and the lit scene can be taken home', async () => {
  await settled(page)
  await unfold(page, 'Take home')
  const download = async (label) => {
    const [file] = await Promise.all([page.waitForEvent('download', { timeout: 180_000 }), press(page, label)])
    return readFileSync(await file.path())
  }
  assert.equal((await download('screenshot (PNG)')).subarray(1, 4).toString(), 'PNG')
  const glb = await download('lit scene (glTF)')
  assert.equal(glb.subarray(0, 4).toString(), 'glTF')
  const json = JSON.parse(glb.subarray(20, 20 + glb.readUInt32LE(12)).toString())
  assert.ok(json.meshes.every((m) => m.primitives.every((p) => '_IRRADIANCE' in p.attributes)))
  assert.equal((await download('picture (OpenEXR)')).readUInt32LE(0), 20000630)
})

test('lamps dim, objects move and vanish, and the light follows', async () => {
  await settled(page)
  const mean = async () => (await status(page)).meanIrradiance
  const bright = await mean()
  await setNumber(page, 'lamp', 0.5)
  await until(page, 'half the light', (b) => window.halflight.status().meanIrradiance < 0.6 * b, 10, bright)
  assert.ok(Math.abs((await mean()) / bright - 0.5) < 0.03)
  // Recoloured: what the filter holds back is missing, the rest stays.
  const tint = control(page, 'lamp').locator('input[type=color]')
  await tint.fill('#ff0000')
  await until(page, 'red light', () => window.halflight.status().groups[0].factor.every((f, k) => Math.abs(f - (k ? 0 : 0.5)) < 0.01), 10)
  await settled(page)
  const red = await picture(page, 'red-lamp').then(() => canvas(page))
  const [r, g] = [0, 1].map((k) => red.data.filter((_, i) => i % 4 === k).reduce((sum, v) => sum + v, 0))
  assert.ok(r > 2 * g, `a red lamp shows ${r} of red and ${g} of green`)
  await tint.fill('#ffffff')
  await setNumber(page, 'lamp', 1)
  await until(page, 'all the light', () => window.halflight.status().groups[0].factor.every((f) => f === 1), 10)
  await settled(page)

  const before = await canvas(page)
  await page.mouse.click(250, 420)
  await until(page, 'an object', () => window.halflight.mover.node !== null)
  await picture(page, 'object')
  const version = (await status(page)).version
  await setNumber(page, 'move y, m', 0.1)
  await until(page, 'new light', (v) => window.halflight.stage.version > v + 1, 20, version)
  await settled(page)
  await page.keyboard.press('Escape')
  const after = await picture(page, 'object-moved').then(() => canvas(page))
  assert.ok(difference(before, after) > 0.01)
  await page.mouse.click(250, 420)
  await until(page, 'an object', () => window.halflight.mover.node !== null)
  const node = await values(() => window.halflight.mover.node)
  await press(page, 'put back')
  await settled(page)
  await control(page, 'in the scene').locator('input').uncheck()
  await until(page, 'the edit', (n) => window.halflight.status().edits.some((e) => e.node === n && !e.shown), 10, node)
  await settled(page)
  await control(page, 'in the scene').locator('input').check()
  await until(page, 'it back', (n) => window.halflight.status().edits.every((e) => e.node !== n || e.shown), 10, node)
  await settled(page)
  await page.keyboard.press('Escape')
  assert.deepEqual(page.complaints, [])
})

test('a room in which nothing is left is shown, and what is put back', async () => {
  const there = await serve(scene('furnace'))
  const room = await open(browser, there.url)
  await lit(room)
  await settled(room)
  const nodes = await room.evaluate(() => window.halflight.stage.header.nodes.map((n) => n.id))
  assert.ok(nodes.length > 0)
  const show = (shown, which) => room.evaluate(async ({ shown, which }) => {
    for (const node of which) await window.halflight.actions.act({ node, shown })
  }, { shown, which })
  let asked = 0
  room.on('request', () => ++asked)
  await show(false, nodes)
  await until(room, 'an empty picture', () => window.halflight.stage.header.triangles === 0, 20)
  await settled(room)
  await room.waitForTimeout(500)
  asked = 0
  await room.waitForTimeout(1000)
  assert.ok(asked < 5, `${asked} requests in a second of quiet`)
  await show(true, nodes.slice(0, 1))
  await until(room, 'an object', () => window.halflight.stage.header.triangles > 0, 20)
  assert.deepEqual(room.complaints, [])
  await room.context().close()
  await there.stop()
})

test('names are only names', async () => {
  const positions = Buffer.from(new Float32Array([0, 0, 0, 2, 0, 0, 0, 2, 0]).buffer)
  const named = join(folder, 'names.gltf')
  const camera = { name: 'first view', type: 'perspective', perspective: { yfov: 0.8, znear: 0.1 } }
  const triangle = (material) => ({ primitives: [{ attributes: { POSITION: 0 }, material }] })
  writeFileSync(named, JSON.stringify({
    asset: { version: '2.0' },
    scenes: [{ nodes: [0, 1, 2, 3] }],
    nodes: [{ mesh: 0, name: '<img src=x>' }, { mesh: 1, translation: [0, 0, 1] }, { camera: 0, translation: [1, 1, 5] }, { camera: 0, translation: [1, 1, 6] }],
    cameras: [camera],
    materials: [{ doubleSided: true, emissiveFactor: [1, 1, 1], name: '__proto__' }, { doubleSided: true }],
    meshes: [triangle(0), triangle(1)],
    accessors: [{ bufferView: 0, componentType: 5126, count: 3, type: 'VEC3', min: [0, 0, 0], max: [2, 2, 0] }],
    bufferViews: [{ buffer: 0, byteLength: 36 }],
    buffers: [{ byteLength: 36, uri: `data:application/octet-stream;base64,${positions.toString('base64')}` }],
  }))
  const there = await serve(named)
  const named_page = await open(browser, there.url)
  await lit(named_page)
  await setNumber(named_page, '__proto__', 0.5)
  await until(named_page, 'half the light', () => window.halflight.status().groups[0].factor.every((f) => f === 0.5), 10)
  const cameras = await control(named_page, 'camera').locator('option').allTextContents()
  assert.deepEqual(cameras, ['first view', 'first view 2', 'first view 3'])
  assert.deepEqual(named_page.complaints, [])
  await named_page.context().close()
  await there.stop()
})

test('the solve is steered: pause, step, feature size, visibility, error, limits, refine here', async () => {
  await settled(page)
  // Paused before there is anything to do: however fast the machine, steps are left.
  await press(page, 'pause')
  await setNumber(page, 'feature size, cm', 0.4)
  await until(page, 'the feature size', () => Math.abs(window.halflight.status().featureSize - 0.004) < 1e-5)
  await until(page, 'a pause', () => window.halflight.status().phase === 'paused')
  const s = await status(page)
  await press(page, 'one step')
  await until(page, 'one iteration', (n) => window.halflight.status().iterations === n + 1, 10, s.iterations)
  await setNumber(page, 'link limit (0: none)', 10)
  await press(page, 'go on')
  await until(page, 'the limit', () => window.halflight.status().phase === 'limited')
  await setNumber(page, 'link limit (0: none)', 0)
  await setNumber(page, 'feature size, cm', 4)
  await settled(page)
  const coarse = (await status(page)).elements
  await press(page, 'refine here')
  await until(page, 'more elements', (n) => window.halflight.status().elements > n, 20, coarse)
  assert.equal((await status(page)).important, true)
  await press(page, 'refine everywhere alike')
  await until(page, 'no view', () => window.halflight.status().important === false)
  await choose(page, 'visibility', 'average')
  await until(page, 'the mode', () => window.halflight.status().visibility === 'average')
  await settled(page)
  await choose(page, 'visibility', 'multires')
  await setNumber(page, 'error, %', 20)
  await until(page, 'the error', () => Math.abs(window.halflight.status().errorWanted - 0.2) < 1e-6)
  await settled(page)
  assert.deepEqual(page.complaints, [])
})

test('it comes back after the server was started again', async () => {
  const args = ['--token', 'abcdefabcdefabcdef', '--feature-size', '4cm']
  let one = await serve(box, ...args)
  const port = new URL(one.url).port
  const there = await open(browser, one.url)
  await lit(there)
  await one.stop()
  await until(there, 'a word on it', () => /Connection lost/.test(document.getElementById('status').textContent))
  one = await serve(box, ...args, '--port', port)
  try {
    await until(there, 'the new session', () => /Solving|Sharpening|Done/.test(document.getElementById('status').textContent), 20)
    await settled(there)
    assert.ok(meanLight(await canvas(there)) > 0.02)
    assert.deepEqual(there.complaints.filter((c) => !/ERR_CONNECTION|ERR_INCOMPLETE|ERR_EMPTY|Failed to fetch|NetworkError/.test(c)), [])
  } finally {
    await one.stop()
    await there.context().close()
  }
})

test('small screens, touch and a dark desk', async () => {
  const small = await open(browser, server.url, { viewport: { width: 390, height: 780 }, hasTouch: true, isMobile: true, colorScheme: 'dark' })
  await lit(small)
  await picture(small, 'small-dark')
  const wide = await small.evaluate(() => document.documentElement.scrollWidth)
  assert.ok(wide <= 390, `the page is ${wide} pixels wide`)
  await small.touchscreen.tap(150, 300)
  await until(small, 'a probe by touch', () => !document.getElementById('probe').hidden)
  const share = await small.evaluate(() => document.getElementById('picture').clientHeight / innerHeight)
  assert.ok(share > 0.5, 'the picture has most of the screen')
  const [text, back] = await small.evaluate(() => {
    const style = getComputedStyle(document.documentElement)
    return [style.color, style.backgroundColor].map((c) => c.match(/\d+/g).slice(0, 3).map(Number))
  })
  const lum = (c) => 0.2126 * linear(c[0]) + 0.7152 * linear(c[1]) + 0.0722 * linear(c[2])
  assert.ok((lum(text) + 0.05) / (lum(back) + 0.05) > 7, 'contrast of the labels')
  assert.deepEqual(small.complaints, [])
  await small.context().close()
})

test('keys are listed, and every control has a name', async () => {
  await page.locator('#picture').focus()
  await page.keyboard.press('?')
  await picture(page, 'help')
  assert.equal(await page.locator('#help').isVisible(), true)
  await page.keyboard.press('Escape')
  assert.equal(await page.locator('#help').isVisible(), false)
  const nameless = await page.evaluate(() =>
    [...document.querySelectorAll('#panel input, #panel select, #panel button')].filter((e) => {
      const label = e.getAttribute('aria-label') ?? (e.getAttribute('aria-labelledby') && document.getElementById(e.getAttribute('aria-labelledby'))?.textContent) ?? e.closest('label')?.textContent ?? e.textContent
      return !label?.trim()
    }).length,
  )
  assert.equal(nameless, 0)
})

test('broken, empty and dark scenes get a sentence and a remedy', async () => {
  const write = (name, text) => {
    const path = join(folder, name)
    writeFileSync(path, text)
    return path
  }
  const cases = [
    [write('broken.gltf', '{"asset": {"version": "2.0"}, "scenes": 3'), 1],
    [write('empty.gltf', '{"asset": {"version": "2.0"}}'), 1],
    [write('dark.obj', 'v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n'), null],
  ]
  for (const [path, exit] of cases) {
    const bad = await serve(path)
    const told = await open(browser, bad.url)
    await until(told, 'a sentence', () => {
      const message = document.getElementById('message')
      return !message.hidden && message.textContent.length > 30
    }, 10)
    await told.screenshot({ path: join(process.env.SHOTS ?? folder, `message-${path.split('/').pop()}.png`) })
    if (exit !== null) {
      assert.equal(await bad.ended, exit)
      assert.match(bad.stderr(), /^halflight: .+\n$/)
      assert.equal(await told.locator('#message').isVisible(), true, 'it stays')
    } else await bad.stop()
    assert.deepEqual(told.complaints.filter((c) => !/ERR_CONNECTION|ERR_INCOMPLETE|ERR_EMPTY/.test(c)), [])
    await told.context().close()
  }
})
