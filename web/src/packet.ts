// Binary answers of the server: see src/halflight/view/packet.h.

interface ArrayPlace {
  type: 'f32' | 'u32'
  offset: number
  count: number
}

export class Packet {
  readonly header: Record<string, any>
  private readonly data: number

  constructor(private readonly buffer: ArrayBuffer) {
    const view = new DataView(buffer)
    if (buffer.byteLength < 8 || view.getUint32(0, true) !== 0x31504c48)
      throw new Error('The server sent something that is no packet. Reload the page.')
    const length = view.getUint32(4, true)
    this.header = JSON.parse(new TextDecoder().decode(new Uint8Array(buffer, 8, length)))
    this.data = 8 + length
  }

  has(name: string): boolean {
    return name in (this.header.arrays ?? {})
  }
  floats(name: string): Float32Array {
    const place = this.place(name, 'f32')
    return new Float32Array(this.buffer, this.data + place.offset, place.count)
  }
  words(name: string): Uint32Array {
    const place = this.place(name, 'u32')
    return new Uint32Array(this.buffer, this.data + place.offset, place.count)
  }

  private place(name: string, type: ArrayPlace['type']): ArrayPlace {
    const place = this.header.arrays?.[name] as ArrayPlace | undefined
    if (!place || place.type !== type) throw new Error(`The server's answer lacks '${name}'.`)
    return place
  }
}
