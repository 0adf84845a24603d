-- SPDX-License-Identifier: BSD-3-Clause
-- Wireshark dissector of the two Unity-Link protocols, lines and frames, for captures made with ?trace=FILE and for TCP
-- streams of it.
--   install   copy this file into the folder that Help > About > Folders names as "Personal Lua Plugins"
--   once      tshark -X lua_script:unitylink.lua -r arm.pcapng
-- On TCP: Analyze > Decode As > TCP port > UNITYLINK. A capture straight from ?trace has a transfer a packet; messages
-- over several packets are put together by `unitylink decode FILE --pcapng OUT`, which also gives each its meaning as a
-- packet comment.

local unitylink = Proto("unitylink", "Unity-Link")
local fields = {
  message = ProtoField.string("unitylink.message", "Message"),
  head = ProtoField.string("unitylink.head", "Head"),
  letters = ProtoField.string("unitylink.letters", "Command or reply"),
  data = ProtoField.string("unitylink.data", "Data"),
  group = ProtoField.uint8("unitylink.group", "Publish group"),
  count = ProtoField.uint8("unitylink.count", "Words as labelled"),
  checksum = ProtoField.string("unitylink.checksum", "Checksum"),
  error = ProtoField.string("unitylink.error", "Error"),
  kind = ProtoField.string("unitylink.kind", "Kind of frame"),
  id = ProtoField.uint16("unitylink.id", "Request"),
  post = ProtoField.uint16("unitylink.post", "Post"),
  status = ProtoField.string("unitylink.status", "Status"),
  sequence = ProtoField.uint16("unitylink.sequence", "Sequence of the publish"),
  clock = ProtoField.uint32("unitylink.clock", "Device clock"),
  payload = ProtoField.bytes("unitylink.payload", "Payload"),
}
unitylink.fields = fields

local heads = {
  ["#"] = "plain", ["$"] = "with checksum", ["%"] = "publish", ["&"] = "publish with checksum",
  ["?"] = "error", ["!"] = "fence",
}

-- One line, at `first` in `buffer`, shown under `tree`; returns what the info column says.
local function dissect_message(buffer, first, length, tree)
  local range = buffer(first, length)
  local text = range:string():gsub("[\r\n]+$", "")
  local branch = tree:add(fields.message, range, text)
  branch:add(fields.head, buffer(first, 1), heads[text:sub(1, 1)] or "not a message")
  local start = text:sub(1, 1) == "!" and 2 or 1
  local letters = text:match("^[#$%%&]([%a_]+)", start)
  if letters then
    branch:add(fields.letters, buffer(first + start, #letters), letters)
  end
  local position, digits = text:match("():([%x,]+)")
  if digits then
    branch:add(fields.data, buffer(first + position, #digits), digits)
    if letters == "PUB" and #digits >= 4 then
      branch:add(fields.group, buffer(first + position, 2), tonumber(digits:sub(1, 2), 16))
      branch:add(fields.count, buffer(first + position + 2, 2), tonumber(digits:sub(3, 4), 16))
    end
  end
  local star, sum = text:match("()%*(%x%x)$")
  if star then
    branch:add(fields.checksum, buffer(first + star - 1, 3), sum)
  end
  local mark, code = text:match("()%?([%w_]+)")
  if mark then
    branch:add(fields.error, buffer(first + mark - 1, #code + 1), code)
  end
  return text
end

-- ---- frames: kind | COBS(payload) | check | 00

local requests = {
  [0] = "HELLO", "OPEN", "READ", "WRITE", "POST", "LIST", "POST_LIST", "EXCHANGE", "READ_CONTROL", "WRITE_CONTROL",
  "DEFINE_GROUP", "DEFINE_EXCHANGE", "SYNC", "CLOSE",
}
local answers = { [0xD0] = "HELLO", [0xD1] = "OPEN", [0xD2] = "PUBLISH", [0xD3] = "CLOSED" }
local statuses = {
  [0] = "ok", "bus_error", "bus_timeout", "bad_address", "denied", "busy", "invalid", "too_long", "order", "behind",
  "no_group",
}

-- What COBS has made of a payload, without its check; nil when it cannot have.
local function decoded(encoded)
  local payload, at = {}, 1
  while at <= #encoded do
    local code = encoded:byte(at)
    if code == 0 or at + code - 1 > #encoded then
      return nil
    end
    payload[#payload + 1] = encoded:sub(at + 1, at + code - 1)
    at = at + code
    if at <= #encoded and code < 255 then
      payload[#payload + 1] = "\0"
    end
  end
  return table.concat(payload)
end

local function number(text, first, bytes)
  local value = 0
  for index = first, first + bytes - 1 do
    value = value * 256 + (text:byte(index) or 0)
  end
  return value
end

-- One frame, its border last; returns what the info column says.
local function dissect_frame(buffer, first, length, tree)
  local range = buffer(first, length)
  local between = range:raw():gsub("%z+$", "")
  local kind = between:byte(1)
  local payload = decoded(between:sub(2, #between - (#between > 259 and 5 or 3)))
    or decoded(between:sub(2, #between - 5))
  local branch = tree:add(fields.message, range, "frame")
  local name, shown
  if kind < 0xC0 then
    local plain = kind == 0x80 or kind == 0x81 or kind == 0x84 or kind == 0x86
    name = requests[plain and kind - 0x80 or kind % 16]
  else
    name = answers[kind] or (statuses[kind - 0xC0] and "REPLY")
  end
  shown = name or string.format("frame %02x", kind)
  branch:add(fields.kind, buffer(first, 1), shown)
  if payload == nil or name == nil then
    branch:add(fields.error, range, "not a frame")
    return shown .. " (damaged)"
  end
  branch:add(fields.payload, range, payload:gsub(".", function(byte) return string.format("%02x", byte:byte()) end))
  if name == "REPLY" then
    branch:add(fields.status, buffer(first, 1), statuses[kind - 0xC0])
    shown = statuses[kind - 0xC0] .. " " .. number(payload, 1, 2)
    branch:add(fields.id, range, number(payload, 1, 2))
  elseif name == "PUBLISH" then
    branch:add(fields.group, range, number(payload, 1, 1))
    branch:add(fields.sequence, range, number(payload, 2, 2))
    branch:add(fields.clock, range, number(payload, 4, 4))
    shown = shown .. " group " .. number(payload, 1, 1)
  elseif name == "POST" or name == "POST_LIST" then
    branch:add(fields.post, range, number(payload, 1, 2))
  elseif kind < 0xC0 and name ~= "HELLO" and name ~= "OPEN" then
    branch:add(fields.id, range, number(payload, 1, 2))
    shown = shown .. " " .. number(payload, 1, 2)
  end
  return shown
end

function unitylink.dissector(buffer, info, tree)
  info.cols.protocol = "UNITYLINK"
  local branch = tree:add(unitylink, buffer())
  local shown, first, framed = {}, 0, nil
  for index = 0, buffer:len() - 1 do
    local byte = buffer(index, 1):uint()
    local last = index == buffer:len() - 1
    if framed == nil and byte == 0 then
      first = index + 1  -- a border before a piece
    else
      if framed == nil then
        framed = byte >= 0x80
      end
      if last or byte == 0 or (byte == 10 and not framed) then
        shown[#shown + 1] = (framed and dissect_frame or dissect_message)(buffer, first, index + 1 - first, branch)
        first, framed = index + 1, nil
      end
    end
  end
  info.cols.info = table.concat(shown, "  ")
end

DissectorTable.get("wtap_encap"):add(wtap.USER0, unitylink)
DissectorTable.get("tcp.port"):add_for_decode_as(unitylink)
