// Writes the seeds that are no text, one folder a target, with the encoders of each format.
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <functional>

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfOutputFile.h>
#include <ImfStdIO.h>
#include <ImfTiledOutputFile.h>
#include <draco/compression/encode.h>
#include <draco/mesh/triangle_soup_mesh_builder.h>
#include <fmt/format.h>
#include <jpeglib.h>
#include <meshoptimizer.h>
#include <png.h>

#include "checkpoint_scene.h"
#include "gltf_builder.h"
#include "halflight/io/read_file.h"

namespace halflight {
namespace {

namespace fs = std::filesystem;

constexpr int kSide = 7;  // texels of pictures

fs::path seed_folder;

fs::path place(const std::string& target, const std::string& name) {
  fs::create_directories(seed_folder / target);
  return seed_folder / target / name;
}

void save(const std::string& target, const std::string& name, std::string_view bytes) {
  std::ofstream(place(target, name), std::ios::binary)
      .write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
}
void save(const std::string& target, const std::string& name, const Bytes& bytes) {
  save(target, name, as_text(bytes));
}

std::uint8_t pattern(int x, int y, int channel) {
  return static_cast<std::uint8_t>(37 * x + 11 * y + 80 * channel);
}

// Of so many bytes a texel, row by row.
Bytes texels(int channels, int side = kSide) {
  Bytes bytes;
  for (int y = 0; y < side; ++y)
    for (int x = 0; x < side; ++x)
      for (int c = 0; c < channels; ++c) bytes.push_back(pattern(x, y, c));
  return bytes;
}

// libpng's own writer: what halflight writes is RGB or RGBA of 8 bits alone.
Bytes png(int colour, int depth, bool interlaced) {
  Bytes bytes;
  png_structp writer = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr, nullptr);
  png_infop info = png_create_info_struct(writer);
  png_set_write_fn(
      writer, &bytes,
      [](png_structp w, png_bytep data, png_size_t size) {
        auto* to = static_cast<Bytes*>(png_get_io_ptr(w));
        to->insert(to->end(), data, data + size);
      },
      nullptr);
  png_set_IHDR(writer, info, kSide, kSide, depth, colour,
               interlaced ? PNG_INTERLACE_ADAM7 : PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT,
               PNG_FILTER_TYPE_DEFAULT);
  std::array<png_color, 4> palette{{{0, 0, 0}, {255, 0, 0}, {0, 255, 0}, {255, 255, 255}}};
  png_byte alpha = 100;
  if (colour == PNG_COLOR_TYPE_PALETTE) {
    png_set_PLTE(writer, info, palette.data(), palette.size());
    png_set_tRNS(writer, info, &alpha, 1, nullptr);
  } else {
    png_set_gAMA(writer, info, 0.45455);
  }
  png_write_info(writer, info);
  Bytes rows = texels(8);
  if (colour == PNG_COLOR_TYPE_PALETTE)
    for (auto& b : rows) b &= depth == 8 ? 3 : 0xff;
  std::vector<png_bytep> starts;
  for (int y = 0; y < kSide; ++y) starts.push_back(&rows[static_cast<std::size_t>(y) * 8 * kSide]);
  png_write_image(writer, starts.data());
  png_write_end(writer, info);
  png_destroy_write_struct(&writer, &info);
  return bytes;
}

void write_pngs() {
  save("png", "grey-1", png(PNG_COLOR_TYPE_GRAY, 1, false));
  save("png", "grey-16", png(PNG_COLOR_TYPE_GRAY, 16, true));
  save("png", "grey-alpha", png(PNG_COLOR_TYPE_GRAY_ALPHA, 8, false));
  save("png", "palette-2", png(PNG_COLOR_TYPE_PALETTE, 2, false));
  save("png", "palette-8", png(PNG_COLOR_TYPE_PALETTE, 8, true));
  save("png", "rgb-16", png(PNG_COLOR_TYPE_RGB, 16, false));
  save("png", "rgba-8", png(PNG_COLOR_TYPE_RGB_ALPHA, 8, true));
}

Bytes jpeg(int channels, J_COLOR_SPACE space, const std::function<void(jpeg_compress_struct&)>& set,
           int side = 2 * kSide) {
  jpeg_compress_struct writer{};
  jpeg_error_mgr errors{};
  writer.err = jpeg_std_error(&errors);
  jpeg_create_compress(&writer);
  unsigned char* memory = nullptr;
  unsigned long size = 0;
  jpeg_mem_dest(&writer, &memory, &size);
  writer.image_width = writer.image_height = static_cast<unsigned>(side);
  writer.input_components = channels;
  writer.in_color_space = space;
  jpeg_set_defaults(&writer);
  jpeg_set_quality(&writer, 40, TRUE);
  set(writer);
  jpeg_start_compress(&writer, TRUE);
  Bytes rows = texels(channels, side);
  while (writer.next_scanline < writer.image_height) {
    JSAMPROW row = &rows[std::size_t{writer.next_scanline} * static_cast<std::size_t>(side) *
                         static_cast<std::size_t>(channels)];
    jpeg_write_scanlines(&writer, &row, 1);
  }
  jpeg_finish_compress(&writer);
  Bytes bytes(memory, memory + size);
  jpeg_destroy_compress(&writer);
  std::free(memory);
  return bytes;
}

void write_jpegs() {
  save("jpeg", "grey", jpeg(1, JCS_GRAYSCALE, [](auto&) {}));
  save("jpeg", "colour", jpeg(3, JCS_RGB, [](auto&) {}));
  save("jpeg", "progressive", jpeg(3, JCS_RGB, [](auto& w) { jpeg_simple_progression(&w); }));
  save("jpeg", "restarts", jpeg(3, JCS_RGB, [](auto& w) { w.restart_interval = 1; }));
  save("jpeg", "cmyk", jpeg(4, JCS_CMYK, [](auto&) {}));
  save("jpeg", "arithmetic", jpeg(3, JCS_RGB, [](auto& w) { w.arith_code = TRUE; }));
}

void write_tgas_and_bmps() {
  const std::string pixels(reinterpret_cast<const char*>(texels(4, 4).data()), 64);
  const auto tga = [&](int kind, int depth, std::string body) {
    std::string file(18, '\0');
    file[1] = static_cast<char>(kind == 1 ? 1 : 0);
    file[2] = static_cast<char>(kind);
    if (kind == 1) file[5] = 4, file[7] = 24;
    file[12] = file[14] = 4;
    file[16] = static_cast<char>(depth);
    return file + std::move(body);
  };
  save("tga_bmp", "tga-24", tga(2, 24, pixels.substr(0, 48)));
  save("tga_bmp", "tga-32", tga(2, 32, pixels));
  save("tga_bmp", "tga-16", tga(2, 16, pixels.substr(0, 32)));
  save("tga_bmp", "tga-grey", tga(3, 8, pixels.substr(0, 16)));
  save("tga_bmp", "tga-palette", tga(1, 8, pixels.substr(0, 12) + std::string(16, '\2')));
  save("tga_bmp", "tga-runs",
       tga(10, 24,
           "\x87"
           "abc"
           "\x03" +
               pixels.substr(0, 12) + "\x83xyz"));
  const auto bmp = [&](int depth, int colours, int compression, std::string body) {
    std::string file = "BM";
    const auto number = [&](std::uint32_t value, int bytes) {
      for (int k = 0; k < bytes; ++k) file += static_cast<char>(value >> (8 * k) & 0xff);
    };
    const auto offset = static_cast<std::uint32_t>(54 + 4 * colours + (compression == 3 ? 12 : 0));
    number(offset + static_cast<std::uint32_t>(body.size()), 4);
    number(0, 4);
    number(offset, 4);
    number(40, 4);
    number(4, 4);
    number(4, 4);
    number(1, 2);
    number(static_cast<std::uint32_t>(depth), 2);
    number(static_cast<std::uint32_t>(compression), 4);
    for (const int n : {static_cast<int>(body.size()), 2835, 2835, colours, 0})
      number(static_cast<std::uint32_t>(n), 4);
    if (compression == 3)
      for (const std::uint32_t mask : {0xf800u, 0x07e0u, 0x001fu}) number(mask, 4);
    for (int c = 0; c < colours; ++c) number(0x00102030u * static_cast<std::uint32_t>(c), 4);
    return file + std::move(body);
  };
  save("tga_bmp", "bmp-24", bmp(24, 0, 0, pixels.substr(0, 48)));
  save("tga_bmp", "bmp-32", bmp(32, 0, 0, pixels));
  save("tga_bmp", "bmp-16-masks", bmp(16, 0, 3, pixels.substr(0, 32)));
  save("tga_bmp", "bmp-palette-8", bmp(8, 4, 0, std::string(16, '\1')));
  save("tga_bmp", "bmp-palette-4", bmp(4, 4, 0, std::string(16, '\x12')));
  save("tga_bmp", "bmp-palette-1", bmp(1, 2, 0, std::string(16, '\x50')));
}

std::string exr(Imf::Compression compression, Imf::PixelType type, bool grey, bool tiled) {
  constexpr std::size_t kPixels = std::size_t{kSide} * kSide;
  std::vector<float> values(4 * kPixels, 0.5f);  // enough for every type of pixel
  Imf::Header header(kSide, kSide);
  header.compression() = compression;
  Imf::FrameBuffer frame;
  for (const char* name : grey ? std::vector{"Y"} : std::vector{"R", "G", "B"}) {
    header.channels().insert(name, Imf::Channel(type));
    frame.insert(name, Imf::Slice(type, reinterpret_cast<char*>(values.data()), 4, 4 * kSide));
  }
  Imf::StdOSStream stream;
  if (tiled) {
    header.setTileDescription(Imf::TileDescription(4, 4, Imf::MIPMAP_LEVELS));
    Imf::TiledOutputFile file(stream, header);
    file.setFrameBuffer(frame);
    for (int level = 0; level < file.numLevels(); ++level)
      file.writeTiles(0, file.numXTiles(level) - 1, 0, file.numYTiles(level) - 1, level);
  } else {
    Imf::OutputFile file(stream, header);
    file.setFrameBuffer(frame);
    file.writePixels(kSide);
  }
  return stream.str();
}

void write_exrs() {
  for (int c = 0; c < Imf::NUM_COMPRESSION_METHODS; ++c)
    save("exr", fmt::format("scan-lines-{}", c),
         exr(static_cast<Imf::Compression>(c), c % 2 == 0 ? Imf::HALF : Imf::FLOAT, c % 3 == 0,
             false));
  save("exr", "tiles", exr(Imf::ZIP_COMPRESSION, Imf::HALF, false, true));
  save("exr", "whole-numbers", exr(Imf::ZIPS_COMPRESSION, Imf::UINT, true, false));
}

const std::vector<float> kCorners{0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0};
const std::vector<std::uint32_t> kTriangles{0, 1, 2, 1, 3, 2};

std::string draco_stream(int method, int speed) {
  draco::TriangleSoupMeshBuilder builder;
  builder.Start(2);
  const int position =
      builder.AddAttribute(draco::GeometryAttribute::POSITION, 3, draco::DT_FLOAT32);
  const int normal = builder.AddAttribute(draco::GeometryAttribute::NORMAL, 3, draco::DT_FLOAT32);
  const int uv = builder.AddAttribute(draco::GeometryAttribute::TEX_COORD, 2, draco::DT_FLOAT32);
  const float up[3] = {0, 0, 1};
  for (std::uint32_t f = 0; f < 2; ++f) {
    const auto corner = [&](std::uint32_t k) {
      return &kCorners[std::size_t{3} * kTriangles[3 * f + k]];
    };
    const draco::FaceIndex face(f);
    builder.SetAttributeValuesForFace(position, face, corner(0), corner(1), corner(2));
    builder.SetAttributeValuesForFace(normal, face, up, up, up);
    builder.SetAttributeValuesForFace(uv, face, corner(0), corner(1), corner(2));
  }
  const auto mesh = builder.Finalize();
  draco::Encoder encoder;
  encoder.SetEncodingMethod(method);
  encoder.SetSpeedOptions(speed, speed);
  if (speed < 10) encoder.SetAttributeQuantization(draco::GeometryAttribute::POSITION, 11);
  draco::EncoderBuffer buffer;
  encoder.EncodeMeshToBuffer(*mesh, &buffer);
  return {buffer.data(), buffer.size()};
}

Bytes meshopt_vertices() {
  Bytes stream(meshopt_encodeVertexBufferBound(4, 12));
  stream.resize(meshopt_encodeVertexBuffer(stream.data(), stream.size(), kCorners.data(), 4, 12));
  return stream;
}
Bytes meshopt_triangles() {
  Bytes stream(meshopt_encodeIndexBufferBound(6, 4));
  stream.resize(meshopt_encodeIndexBuffer(stream.data(), stream.size(), kTriangles.data(), 6));
  return stream;
}
Bytes meshopt_indices() {
  Bytes stream(meshopt_encodeIndexSequenceBound(6, 4));
  stream.resize(meshopt_encodeIndexSequence(stream.data(), stream.size(), kTriangles.data(), 6));
  return stream;
}

// As meshopt.cpp takes them apart.
Bytes behind(std::array<std::uint8_t, 4> choice, const Bytes& stream) {
  Bytes all(choice.size() + stream.size());
  std::copy(stream.begin(), stream.end(), std::copy(choice.begin(), choice.end(), all.begin()));
  return all;
}

void write_compressed() {
  save("draco", "sequential", draco_stream(draco::MESH_SEQUENTIAL_ENCODING, 5));
  save("draco", "sequential-plain", draco_stream(draco::MESH_SEQUENTIAL_ENCODING, 10));
  save("draco", "edgebreaker", draco_stream(draco::MESH_EDGEBREAKER_ENCODING, 5));
  save("draco", "edgebreaker-slow", draco_stream(draco::MESH_EDGEBREAKER_ENCODING, 0));
  save("meshopt", "vertices", behind({0, 0, 12, 4}, meshopt_vertices()));
  save("meshopt", "exponents", behind({0, 3, 12, 4}, meshopt_vertices()));
  save("meshopt", "triangles", behind({1, 0, 4, 6}, meshopt_triangles()));
  save("meshopt", "indices", behind({2, 0, 2, 6}, meshopt_indices()));
  for (const std::uint8_t filter : {1, 2}) {
    Bytes stream(meshopt_encodeVertexBufferBound(6, 8));
    stream.resize(meshopt_encodeVertexBuffer(stream.data(), stream.size(), kCorners.data(), 6, 8));
    save("meshopt", fmt::format("filter-{}", filter), behind({0, filter, 8, 6}, stream));
  }
}

void write_glbs() {
  GltfBuilder textured;
  const Bytes picture = png(PNG_COLOR_TYPE_RGB_ALPHA, 8, false);
  textured.json["images"] = {
      {{"bufferView", textured.add_view(picture)}, {"mimeType", "image/png"}}};
  textured.json["samplers"] = {{{"wrapS", 33071}, {"wrapT", 33648}}};
  textured.json["textures"] = {{{"source", 0}, {"sampler", 0}}};
  textured.add_triangle(
      {{"pbrMetallicRoughness",
        {{"baseColorTexture",
          {{"index", 0},
           {"extensions",
            {{"KHR_texture_transform", {{"offset", {0.5, 0.5}}, {"rotation", 1}}}}}}}}},
       {"alphaMode", "MASK"},
       {"emissiveFactor", {1, 1, 1}},
       {"extensions", {{"KHR_materials_emissive_strength", {{"emissiveStrength", 5}}}}}});
  save("glb", "textured", textured.glb());

  GltfBuilder draco;
  const std::string stream = draco_stream(draco::MESH_EDGEBREAKER_ENCODING, 5);
  const std::size_t view = draco.add_view(Bytes(stream.begin(), stream.end()));
  draco.json["extensionsRequired"] = {"KHR_draco_mesh_compression"};
  const std::size_t corners =
      draco.add("accessors", {{"componentType", 5126}, {"type", "VEC3"}, {"count", 4}});
  draco.add_root(
      {{"mesh",
        draco.add_mesh({{"attributes", {{"POSITION", corners}}},
                        {"extensions",
                         {{"KHR_draco_mesh_compression",
                           {{"bufferView", view}, {"attributes", {{"POSITION", 0}}}}}}}})}});
  save("glb", "draco", draco.glb());

  GltfBuilder meshopt;
  const Bytes packed = meshopt_vertices();
  const std::size_t from = meshopt.add_view(packed);
  const std::size_t unpacked = meshopt.add(
      "bufferViews", {{"buffer", 0},
                      {"byteLength", 48},
                      {"extensions",
                       {{"EXT_meshopt_compression",
                         {{"buffer", 0},
                          {"byteOffset", meshopt.json["bufferViews"][from]["byteOffset"]},
                          {"byteLength", packed.size()},
                          {"byteStride", 12},
                          {"mode", "ATTRIBUTES"},
                          {"count", 4}}}}}});
  const std::size_t positions = meshopt.add(
      "accessors",
      {{"bufferView", unpacked}, {"componentType", 5126}, {"type", "VEC3"}, {"count", 4}});
  const std::size_t indices = meshopt.add_accessor(kTriangles, 5125, "SCALAR", 1);
  meshopt.add_root({{"mesh", meshopt.add_mesh({{"attributes", {{"POSITION", positions}}},
                                               {"indices", indices}})}});
  save("glb", "meshopt", meshopt.glb());

  GltfBuilder instances;
  instances.add_triangle();
  const std::size_t shifts = instances.add_positions({0, 0, 0, 2, 0, 0});
  instances.json["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"] = {
      {"TRANSLATION", shifts}};
  instances.json["cameras"] = {
      {{"type", "perspective"}, {"perspective", {{"yfov", 1}, {"znear", 0.1}}}}};
  instances.add_root({{"camera", 0}, {"rotation", {0, 0, 0, 1}}});
  instances.json["extensions"]["KHR_lights_punctual"]["lights"] = {
      {{"type", "spot"}, {"intensity", 10}, {"spot", {{"outerConeAngle", 0.5}}}}};
  instances.add_root({{"extensions", {{"KHR_lights_punctual", {{"light", 0}}}}}});
  save("glb", "instances", instances.glb());
}

// Values nested far deeper than the stack could follow.
void write_nested() {
  const std::string open = "{\"kind\":\"features\",\"view\":" + std::string(50'000, '[');
  const auto closed = [](std::size_t n) { return std::string(n, '[') + std::string(n, ']'); };
  const std::string view = "{\"kind\":\"features\",\"view\":" + closed(25'000) + "}";
  save("view_command", "nested", "{\"important\":" + closed(25'000) + "}");
  for (const std::string& body : {open, view})
    save("http", fmt::format("nested-{}", body.size()),
         fmt::format("POST /0123456789abcdef/api/layer HTTP/1.1\r\nHost: @HOST@\r\n"
                     "Content-Length: {}\r\n\r\n{}",
                     body.size(), body));
  std::string rules = "a";
  for (int i = 0; i < 30'000; ++i) rules += ".a";
  save("rules", "nested", rules + " = 1\n");
}

// Before, in the middle of and after a solve; by both kinds of links.
Result<void> write_checkpoints() {
  const auto world = fuzz::checkpoint_world();
  for (const LinkMaker links : {LinkMaker::refined, LinkMaker::sampled}) {
    SolveOrigin origin = fuzz::checkpoint_origin(*world, links);
    origin.scene.path = place("checkpoint", "scene.glb");
    SolverState state = make_state(world, origin.options);
    for (int i = 0; i < 30; ++i) {
      const std::string name =
          fmt::format("{}-{}", links == LinkMaker::refined ? "refined" : "sampled", i);
      if (i == 0 || i == 2 || state.done())
        if (auto ok = write_checkpoint(place("checkpoint", name), origin, state); !ok) return ok;
      if (state.done()) break;
      advance(state, {}, {.links = 400});
    }
  }
  return {};
}

}  // namespace
}  // namespace halflight

int main(int argc, char** argv) {
  using namespace halflight;
  if (argc != 2) {
    std::fprintf(stderr, "usage: fuzz_write_seeds FOLDER\n");
    return 1;
  }
  seed_folder = argv[1];
  write_pngs();
  write_jpegs();
  write_tgas_and_bmps();
  write_exrs();
  write_compressed();
  write_glbs();
  write_nested();
  if (const auto written = write_checkpoints(); !written) {
    std::fprintf(stderr, "%s\n", written.error().line().c_str());
    return 2;
  }
  return 0;
}
