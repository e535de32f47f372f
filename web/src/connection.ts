// Everything that is asked of the server, and its status as it comes.
import { Packet } from './packet'

export interface Status {
  session: string
  number: number
  phase: 'loading' | 'building' | 'solving' | 'paused' | 'limited' | 'sharpening' | 'done' | 'failed'
  sentence: string
  remedy: string
  epoch?: number
  version: number
  sharp?: boolean
  stage?: string
  level?: number
  levels?: number
  receivers?: number
  receiversLeft?: number
  elements?: number
  clusters?: number
  links?: number
  rays?: number
  iterations?: number
  records: number
  meanIrradiance?: number
  solvingSeconds?: number
  firstLightSeconds?: number
  cpuSeconds?: number
  wallSeconds?: number
  featureSize?: number
  errorWanted?: number
  visibility?: string
  visibilityWanted?: string
  paused?: boolean
  secondsLimit?: number
  linksLimit?: number
  important?: boolean
  error?: { estimated: number; noise: number }
  groups?: { name: string; factor: [number, number, number] }[]
  edits?: { node: number; offset: [number, number, number]; shown: boolean }[]
  warnings?: string[]
}

export interface View {
  position: number[]
  forward: number[]
  up: number[]
  fov: number
  width: number
  height: number
}

export class RequestError extends Error {
  constructor(
    message: string,
    readonly remedy: string,
  ) {
    super(remedy ? `${message} (${remedy})` : message)
  }
}

const kRetryMilliseconds = 1000

export class Connection {
  onStatus: (status: Status) => void = () => {}
  onLost: () => void = () => {}
  private events: EventSource | null = null

  open(): void {
    this.events?.close()
    const events = new EventSource('api/events')
    this.events = events
    events.onmessage = (event) => this.onStatus(JSON.parse(event.data) as Status)
    events.onerror = () => {
      // Tried anew here, as the browser gives up on answers that are no stream.
      events.close()
      if (this.events !== events) return
      this.events = null
      this.onLost()
      setTimeout(() => this.events ?? this.open(), kRetryMilliseconds)
    }
  }

  topology(): Promise<Packet | null> {
    return this.packet('api/topology')
  }
  light(epoch: number, since: number): Promise<Packet | null> {
    return this.packet(`api/light?epoch=${epoch}&since=${since}`)
  }
  async history(since: number): Promise<{ first: number; records: any[] }> {
    return (await this.checked(await fetch(`api/history?since=${since}`))).json()
  }
  async control(command: object): Promise<void> {
    await this.post('api/control', command)
  }
  async probe(origin: number[], direction: number[], exact: boolean): Promise<any> {
    return (await this.post('api/probe', { origin, direction, exact })).json()
  }
  async layer(what: object): Promise<Packet> {
    return new Packet(await (await this.post('api/layer', what)).arrayBuffer())
  }
  async layerText(what: object): Promise<any> {
    return (await this.post('api/layer', what)).json()
  }
  async download(path: string, what: object): Promise<Blob> {
    return (await this.post(path, what)).blob()
  }

  private async post(path: string, what: object): Promise<Response> {
    return this.checked(await fetch(path, { method: 'POST', body: JSON.stringify(what) }))
  }
  private async packet(path: string): Promise<Packet | null> {
    const bytes = await (await this.checked(await fetch(path))).arrayBuffer()
    return bytes.byteLength > 0 ? new Packet(bytes) : null
  }
  private async checked(response: Response): Promise<Response> {
    if (response.ok) return response
    const told = await response.json().catch(() => ({}))
    throw new RequestError(told.error ?? `The server answered ${response.status}.`, told.remedy ?? '')
  }
}
