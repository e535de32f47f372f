// A browser and the program under test. HALFLIGHT is the program, SHOTS where screenshots go.
import { spawn, spawnSync } from 'node:child_process'
import { mkdirSync, mkdtempSync, rmSync } from 'node:fs'
import { tmpdir } from 'node:os'
import { join } from 'node:path'
import { chromium } from 'playwright-core'
import { PNG } from 'pngjs'

export const program = process.env.HALFLIGHT
export const shots = process.env.SHOTS ?? join(tmpdir(), 'halflight-shots')
mkdirSync(shots, { recursive: true })
export const folder = mkdtempSync(join(tmpdir(), 'halflight-web-'))
process.on('exit', () => rmSync(folder, { recursive: true, force: true }))

export function run(...args) {
  const done = spawnSync(program, args, { encoding: 'utf8' })
  if (done.status !== 0) throw new Error(`${args.join(' ')}: ${done.stderr}`)
  return done.stdout
}

export function scene(name, ...args) {
  const path = join(folder, `${[name, ...args].join('').replace(/[^a-z0-9]/gi, '')}.glb`)
  run('scene', name, ...args, '-o', path)
  return path
}

export function launch() {
  return chromium.launch({
    executablePath: process.env.CHROMIUM ?? '/usr/bin/chromium',
    args: [
      '--headless=new',
      '--no-sandbox',
      '--enable-unsafe-swiftshader',
      '--use-angle=swiftshader',
      '--disable-quic',
      '--no-first-run',
      '--disable-background-networking',
      '--disable-component-update',
      '--disable-sync',
    ],
  })
}

// The server as a user starts it; `start` is when, in milliseconds.
export async function serve(path, ...args) {
  const start = Date.now()
  const child = spawn(program, ['view', path, ...args], { stdio: ['ignore', 'pipe', 'pipe'] })
  let stderr = ''
  child.stderr.on('data', (text) => (stderr += text))
  const ended = new Promise((resolve) => child.on('exit', (status) => resolve(status)))
  const url = await new Promise((resolve, reject) => {
    child.stdout.once('data', (text) => resolve(String(text).trim()))
    ended.then(() => reject(new Error(stderr)))
  })
  return {
    url,
    start,
    ended,
    stderr: () => stderr,
    async stop() {
      child.kill('SIGTERM')
      await ended
    },
  }
}

// A page that remembers what it complained about.
export async function open(browser, url, options = {}) {
  const context = await browser.newContext({ viewport: { width: 1100, height: 700 }, acceptDownloads: true, ...options })
  const page = await context.newPage()
  page.complaints = []
  page.on('console', (message) => {
    if (['error', 'warning'].includes(message.type()) && !/GPU stall due to ReadPixels/.test(message.text()))
      page.complaints.push(message.text())
  })
  page.on('pageerror', (error) => page.complaints.push(String(error)))
  await page.goto(url)
  return page
}

export const status = (page) => page.evaluate(() => window.halflight.status())

export async function until(page, what, condition, seconds = 60, argument = undefined) {
  try {
    await page.waitForFunction(condition, argument, { timeout: 1000 * seconds, polling: 50 })
  } catch {
    throw new Error(`waited ${seconds} s for ${what}; status: ${JSON.stringify(await status(page))}`)
  }
}
export const lit = (page, seconds = 60) =>
  until(page, 'light', () => window.halflight?.stage.header !== null && window.halflight?.stage.frames > 0, seconds)
// Everything has arrived and been drawn.
export const settled = (page, seconds = 90) =>
  until(
    page,
    'a finished solution',
    () => {
      const { stage, status } = window.halflight
      const s = status()
      return s?.phase === 'done' && s.epoch === stage.epoch && s.version === stage.version
    },
    seconds,
  )

export async function drawn(page) {
  const frames = await page.evaluate(() => (window.halflight.stage.draw(), window.halflight.stage.frames))
  await page.waitForFunction((before) => window.halflight.stage.frames > before + 0, frames)
}

export async function picture(page, name, clip = undefined) {
  await page.evaluate(() => window.halflight.stage.finish())
  return PNG.sync.read(await page.screenshot({ path: join(shots, `${name}.png`), clip }))
}

// Pixels of the canvas alone, all of the picture at its own resolution.
export async function canvas(page) {
  const url = await page.evaluate(() => (window.halflight.stage.finish(), window.halflight.stage.canvas.toDataURL()))
  return PNG.sync.read(Buffer.from(url.split(',')[1], 'base64'))
}

export const linear = (byte) => {
  const c = byte / 255
  return c <= 0.04045 ? c / 12.92 : ((c + 0.055) / 1.055) ** 2.4
}

export function meanLight(png) {
  let sum = 0
  for (let i = 0; i < png.data.length; i += 4)
    sum += 0.2126 * linear(png.data[i]) + 0.7152 * linear(png.data[i + 1]) + 0.0722 * linear(png.data[i + 2])
  return sum / (png.data.length / 4)
}

// Share of pixels that differ by more than a few steps.
export function difference(a, b) {
  let differ = 0
  for (let i = 0; i < a.data.length; i += 4)
    differ += Math.max(...[0, 1, 2].map((k) => Math.abs(a.data[i + k] - b.data[i + k]))) > 6 ? 1 : 0
  return differ / (a.data.length / 4)
}

// A control of the side panel by its label.
export function control(page, label) {
  return page.locator('.lil-controller', { has: page.locator('.lil-name', { hasText: new RegExp(`^${label.replace(/[()/.]/g, '\\$&')}$`) }) })
}
export async function setNumber(page, label, value) {
  const input = control(page, label).locator('input:not([type=color])').last()
  await input.fill(String(value))
  await input.press('Enter')
  await input.blur()
}
export const choose = (page, label, value) => control(page, label).locator('select').selectOption({ label: value })
export const press = (page, label) =>
  page.locator('.lil-controller button', { has: page.locator('.lil-name', { hasText: new RegExp(`^${label.replace(/[()/.]/g, '\\$&')}$`) }) }).click()
export const unfold = async (page, title) => {
  const folder = page.locator('.lil-gui:not(.lil-root)', { has: page.locator(`> .lil-title`, { hasText: new RegExp(`^${title}$`) }) })
  if (await folder.evaluate((e) => e.classList.contains('lil-closed'))) await folder.locator('> .lil-title').click()
}
