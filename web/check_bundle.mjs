// Builds the page anew and compares it with what lies in dist: the bundle comes from these sources.
// Exit status 77: this machine's Node.js is too old for the tools, nothing was compared.
import { spawnSync } from 'node:child_process'
import { mkdtempSync, readFileSync, readdirSync, rmSync } from 'node:fs'
import { tmpdir } from 'node:os'
import { dirname, join } from 'node:path'
import { fileURLToPath } from 'node:url'

const here = dirname(fileURLToPath(import.meta.url))
const kLeastNode = [20, 19]
const [major, minor] = process.versions.node.split('.').map(Number)
if (major < kLeastNode[0] || (major === kLeastNode[0] && minor < kLeastNode[1])) {
  console.log(`Node.js ${process.versions.node} is older than ${kLeastNode.join('.')}: nothing compared`)
  process.exit(77)
}
const out = mkdtempSync(join(tmpdir(), 'halflight-bundle-'))
try {
  for (const [tool, ...args] of [['tsc', '--noEmit'], ['vite', 'build', '--outDir', out, '--emptyOutDir', '--logLevel', 'warn']]) {
    const done = spawnSync(join(here, 'node_modules', '.bin', tool), args, { cwd: here, stdio: 'inherit' })
    if (done.status !== 0) throw new Error(`${tool} failed`)
  }
  const names = readdirSync(out).sort()
  const known = readdirSync(join(here, 'dist')).sort()
  if (names.join() !== known.join()) throw new Error(`built ${names}, dist has ${known}`)
  for (const name of names)
    if (!readFileSync(join(out, name)).equals(readFileSync(join(here, 'dist', name))))
      throw new Error(`web/dist/${name} is not what the sources give: run npm run build in web/ and commit it`)
  console.log(`web/dist comes from its sources: ${names.join(', ')}`)
} catch (error) {
  console.error(error.message)
  process.exitCode = 1
} finally {
  rmSync(out, { recursive: true, force: true })
}
