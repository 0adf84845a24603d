-- SPDX-License-Identifier: BSD-3-Clause
-- Wireshark dissector of the classic Unity-Link protocol, for captures made with ?trace=FILE and for TCP streams of it.
--   install   copy this file into the folder that Help > About > Folders names as "Personal Lua Plugins"
--   once      tshark -X lua_script:unitylink.lua -r arm.pcapng
-- On TCP: Analyze > Decode As > TCP port > UNITYLINK. A capture straight from ?trace has a transfer a packet; messages over several
-- packets are put together by `unitylink decode FILE --pcapng OUT`, which also gives each its meaning as a packet comment.

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
}
unitylink.fields = fields

local heads = {
  ["#"] = "plain", ["$"] = "with checksum", ["%"] = "publish", ["&"] = "publish with checksum", ["?"] = "error", ["!"] = "fence",
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

function unitylink.dissector(buffer, info, tree)
  info.cols.protocol = "UNITYLINK"
  local branch = tree:add(unitylink, buffer())
  local shown, first = {}, 0
  for index = 0, buffer:len() - 1 do
    if buffer(index, 1):uint() == 10 or index == buffer:len() - 1 then
      shown[#shown + 1] = dissect_message(buffer, first, index + 1 - first, branch)
      first = index + 1
    end
  end
  info.cols.info = table.concat(shown, "  ")
end

DissectorTable.get("wtap_encap"):add(wtap.USER0, unitylink)
DissectorTable.get("tcp.port"):add_for_decode_as(unitylink)
