// A million triangles stay usable, and the first light of an office comes soon.
import assert from 'node:assert/strict'
import { after, before, test } from 'node:test'
import { launch, lit, open, picture, meanLight, scene, serve, status, until } from './browser.mjs'

let browser
before(async () => (browser = await launch()))
after(() => browser.close())

// Frames a second while the camera is turned around.
async function turn(page, seconds) {
  const from = await page.evaluate(() => window.halflight.stage.frames)
  const start = Date.now()
  await page.mouse.move(300, 350)
  await page.mouse.down()
  for (let i = 0; Date.now() - start < 1000 * seconds; ++i) await page.mouse.move(300 + 200 * Math.sin(i / 10), 350 + 60 * Math.cos(i / 10))
  await page.mouse.up()
  const frames = (await page.evaluate(() => window.halflight.stage.frames)) - from
  return (1000 * frames) / (Date.now() - start)
}

test('an office is lit soon and can be looked around in while it is solved', async () => {
  const path = scene('office')
  const server = await serve(path)
  const page = await open(browser, server.url)
  await lit(page)
  const firstFrame = (Date.now() - server.start) / 1000
  const before = await status(page)
  const pace = await turn(page, 4)
  const now = await status(page)
  const share = (now.cpuSeconds - before.cpuSeconds) / (now.wallSeconds - before.wallSeconds)
  console.log(`office: first lit frame ${firstFrame.toFixed(2)} s, light ${now.firstLightSeconds.toFixed(2)} s, ${pace.toFixed(1)} frames/s while solving, server uses ${share.toFixed(2)} cores`)
  assert.ok(firstFrame < 20)
  assert.ok(now.iterations > before.iterations, 'it solves on meanwhile')
  assert.ok(pace > 1)
  assert.deepEqual(page.complaints, [])
  await page.context().close()
  await server.stop()
})

test('a million triangles are shown, lit and turned', async () => {
  const path = scene('loose-triangles', '--count', '1000000')
  const server = await serve(path)
  const page = await open(browser, server.url)
  await lit(page, 180)
  const firstFrame = (Date.now() - server.start) / 1000
  const pace = await turn(page, 4)
  const s = await status(page)
  console.log(`a million triangles: first lit frame ${firstFrame.toFixed(1)} s, ${pace.toFixed(1)} frames/s, ${await page.evaluate(() => window.halflight.stage.header.vertices)} vertices`)
  assert.ok(meanLight(await picture(page, 'million')) > 0.005)
  assert.ok(pace > 0.3)
  await until(page, 'more light', (v) => window.halflight.stage.version > v, 60, await page.evaluate(() => window.halflight.stage.version))
  assert.notEqual(s.phase, 'failed')
  assert.deepEqual(page.complaints, [])
  await page.context().close()
  await server.stop()
})
